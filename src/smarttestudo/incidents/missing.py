# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parts of its window that an incident lacks."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from smarttestudo.domain.incident import Missing, MissingReason
from smarttestudo.domain.units import NS_PER_S, counted, grouped
from smarttestudo.incidents.topic_ring import GivenUp, SourceMessage, together

_MOST_NAMED = 3


def unsubscribed(topic: str, from_ns: int, to_ns: int, reason: MissingReason = MissingReason.LATE) -> Missing:
    """Entry for ``topic``, to which nobody was subscribed between two stamps."""
    return Missing(topic=topic, reason=reason, messages=None, from_ns=from_ns, to_ns=to_ns)


def add_unsubscribed(missing: list[Missing], added: Missing) -> None:
    """Add that nobody was subscribed to a topic, together with the time right before it."""
    for place, known in enumerate(missing):
        if (known.topic, known.reason, known.to_ns) == (added.topic, added.reason, added.from_ns):
            missing[place] = replace(known, to_ns=added.to_ns)
            return
    missing.append(added)


def missing_for_memory(
    given_up: Mapping[str, Sequence[GivenUp]], is_held: Callable[[int], bool] | None = None
) -> Iterator[Missing]:
    """Messages of each topic that memory did not hold; those whose number ``is_held`` are not missing."""
    for topic, messages in given_up.items():
        lacking: Sequence[int] = range(len(messages))
        if is_held is not None:
            # A list of the messages would take more memory than all that is kept of them.
            lacking = array("q", (at for at, message in enumerate(messages) if not is_held(message.number)))
        if lacking:
            yield Missing(
                topic=topic,
                reason=MissingReason.MEMORY,
                messages=len(lacking),
                from_ns=messages[lacking[0]].stamp_ns,
                to_ns=messages[lacking[-1]].stamp_ns,
            )


LOSSES_APART_NS = NS_PER_S // 10
"""Losses of a topic that lie closer count as one: in a flood there is one before almost each message."""
MOST_LOSSES = 100
"""How many losses of a topic one window lists."""


def add_loss(losses: list[Missing], loss: Missing) -> None:
    """Add a loss of the same topic, together with the last where that is close, or where there are many."""
    last = losses[-1] if losses else None
    if last is None or (loss.from_ns - last.to_ns > LOSSES_APART_NS and len(losses) < MOST_LOSSES):
        losses.append(loss)
    else:
        losses[-1] = together(last, loss)


def missing_text(missing: Iterable[Missing]) -> str:
    """Words for what is missing and was counted, the most first; empty where nothing was."""
    counts = Counter[tuple[str, str]]()
    for entry in missing:
        counts[entry.topic, entry.reason.value] += entry.messages or 0
    named = [
        f"{grouped(count)} of {topic} ({reason})" for (topic, reason), count in counts.most_common() if count
    ]
    more = f" and of {counted(len(named) - _MOST_NAMED, 'topic')} more" if len(named) > _MOST_NAMED else ""
    return f"lacks {', '.join(named[:_MOST_NAMED])}{more}" if named else ""


def without(given_up: Sequence[GivenUp], topic: str, messages: Sequence[SourceMessage]) -> Sequence[GivenUp]:
    """``given_up`` of ``topic``, without what is in ``messages``."""
    found = {message.number for message in messages if message.topic == topic}
    return [one for one in given_up if one.number not in found] if found else given_up


class LostMessages:
    """Counts messages by topic, from the first to the last."""

    def __init__(self) -> None:
        self._topics: dict[str, Missing] = {}

    def add(self, topic: str, stamp_ns: int) -> None:
        """Count a lost message."""
        known = self._topics.get(topic)
        if known is None:
            known = Missing(
                topic=topic, reason=MissingReason.DISK, messages=0, from_ns=stamp_ns, to_ns=stamp_ns
            )
        self._topics[topic] = replace(known, messages=(known.messages or 0) + 1, to_ns=stamp_ns)

    def missing(self) -> tuple[Missing, ...]:
        """Losses for the record of an incident."""
        return tuple(self._topics.values())
