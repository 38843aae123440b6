# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parts of its window that an incident lacks."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence

from smarttestudo.domain.incident import Missing, MissingReason
from smarttestudo.incidents.topic_ring import GivenUp, SourceMessage


def unheard(topic: str, from_ns: int, to_ns: int, reason: MissingReason = MissingReason.LATE) -> Missing:
    """That nobody heard ``topic`` between two stamps."""
    return Missing(topic=topic, reason=reason, messages=None, from_ns=from_ns, to_ns=to_ns)


def missing_for_memory(
    given_up: Mapping[str, Sequence[GivenUp]], is_held: Callable[[int], bool] | None = None
) -> Iterator[Missing]:
    """Messages of each topic that memory did not hold; those whose number ``is_held`` are not missing."""
    for topic, messages in given_up.items():
        lacking: Sequence[int] = range(len(messages))
        if is_held is not None:
            # A list of the messages would take more memory than all that is kept of them.
            lacking = array("q", (at for at, one in enumerate(messages) if not is_held(one.number)))
        if lacking:
            yield Missing(
                topic=topic,
                reason=MissingReason.MEMORY,
                messages=len(lacking),
                from_ns=messages[lacking[0]].stamp_ns,
                to_ns=messages[lacking[-1]].stamp_ns,
            )


def without(given_up: Sequence[GivenUp], topic: str, messages: Sequence[SourceMessage]) -> Sequence[GivenUp]:
    """``given_up`` of ``topic``, without what is in ``messages``."""
    found = {message.number for message in messages if message.topic == topic}
    return [one for one in given_up if one.number not in found] if found else given_up
