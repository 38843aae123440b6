# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of a recording as its metadata count them, and as they can be read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from smarttestudo.domain.units import counted, grouped

_MOST_NAMES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageCounts:
    """Messages in all, by topic, and by the name of their file; all are 0 or empty where nothing tells."""

    total: int = 0
    topics: Mapping[str, int] = field(default_factory=dict)
    files: Mapping[str, int] = field(default_factory=dict)

    def shares(self, held: MessageCounts) -> Iterator[float]:
        """How much of these is ``held``, in all, by topic and by file: no gain hides a loss."""
        for promised, found in (
            ({"": self.total}, {"": held.total}),
            (self.topics, held.topics),
            (self.files, held.files),
        ):
            if total := sum(promised.values()):
                yield sum(min(count, found.get(name, 0)) for name, count in promised.items()) / total

    def notice(self, held: MessageCounts) -> str | None:
        """Where ``held`` differs from these, for topics and files that these name."""
        differ = _differing(self.topics, held.topics)
        if len(self.files) > 1 or self.total == held.total:
            differ += _differing(self.files, held.files)
        if self.total and self.total != held.total:
            text = f"its metadata count {_both(counted(self.total, 'message'), held.total)}"
        elif differ:
            text = "its metadata count other messages than can be read"
        else:
            return None
        listed = [f"of {one}" for one in differ[:_MOST_NAMES]]
        if len(differ) > _MOST_NAMES:
            listed.append(f"{grouped(len(differ) - _MOST_NAMES)} more differ")
        return "; ".join((text, *listed))


def _differing(promised: Mapping[str, int], held: Mapping[str, int]) -> list[str]:
    return [
        f"{name} {_both(grouped(count), held.get(name, 0))}"
        for name, count in promised.items()
        if count != held.get(name, 0)
    ]


def _both(promised: str, held: int) -> str:
    return f"{promised}, {grouped(held)} can be read"
