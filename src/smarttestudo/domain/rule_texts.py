# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The texts of the rules that a runtime follows, for others to read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from smarttestudo.domain.record.plain import read_any


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleTexts:
    """Rule files with their names, in their order; none while there are no rules.

    ``sha256`` is that of the texts, one after the other. ``full_names`` are those of the topics that the
    texts call otherwise: relative ones, remapped ones, or all of them below a prefix.
    """

    sha256: str = ""
    files: tuple[tuple[str, str], ...] = ()
    full_names: Mapping[str, str] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """All of them as one text, which means the same."""
        return "\n".join(text for _, text in self.files)

    def to_text(self) -> str:
        """As JSON."""
        return json.dumps(
            {
                "sha256": self.sha256,
                "files": [{"name": name, "text": text} for name, text in self.files],
                "full_names": dict(self.full_names),
            },
            ensure_ascii=False,
        )

    @staticmethod
    def from_text(text: str) -> RuleTexts:
        """Rule texts that ``to_text`` wrote. Raises ``ValueError``."""
        try:
            record: Any = read_any(json.loads(text))
            return RuleTexts(
                sha256=str(record["sha256"]),
                files=tuple((str(file["name"]), str(file["text"])) for file in record["files"]),
                full_names={str(name): str(full) for name, full in record["full_names"].items()},
            )
        except (TypeError, KeyError, AttributeError, RecursionError) as error:
            raise ValueError(str(error)) from error
