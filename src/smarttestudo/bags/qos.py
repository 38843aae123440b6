# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Quality-of-service profiles as bags hold them."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum
from functools import lru_cache
from typing import Any

from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2.errors import ReaderError
from rosbags.rosbag2.metadata import parse_qos

from smarttestudo.domain import robot

_TEXTS_KEPT = 64
_UNLIMITED = QosTime(9223372036, 854775807)


def stored_qos(qos: robot.Qos) -> Qos:
    """Stored form of a publisher's ``qos``, as a bag has it."""
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=qos.depth,
        reliability=QosReliability.RELIABLE if qos.reliable else QosReliability.BEST_EFFORT,
        durability=QosDurability.TRANSIENT_LOCAL if qos.transient_local else QosDurability.VOLATILE,
        deadline=_UNLIMITED,
        lifespan=_UNLIMITED,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=_UNLIMITED,
        avoid_ros_namespace_conventions=False,
    )


class QosReader:
    """Reads ``offered_qos_profiles`` entries: YAML text up to version 8 of the metadata, a list from 9 on."""

    def __init__(self) -> None:
        self.notices: list[str] = []
        """A line for each topic whose entry ``read_or_note`` could not read."""

    def read(self, stored: Any) -> tuple[Qos, ...]:
        """The profiles in an entry.

        Raises ``ValueError`` where it holds something else.
        """
        return _parsed_text(stored) if isinstance(stored, str) else _parse(stored)

    def read_or_note(self, topic: str, stored: Any) -> tuple[Qos, ...]:
        """The profiles in the entry of ``topic``; none, and a notice, where it makes no sense."""
        try:
            return self.read(stored)
        except ValueError:
            self.notices.append(f"the QoS profiles of {topic} cannot be read and were left out")
            return ()


# The topics of all recordings mostly share a few texts, and YAML is slow.
@lru_cache(maxsize=_TEXTS_KEPT)
def _parsed_text(stored: str) -> tuple[Qos, ...]:
    return _parse(stored)


def _parse(stored: Any) -> tuple[Qos, ...]:
    try:
        return tuple(parse_qos(stored or []))
    except (ReaderError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError("these are no QoS profiles") from error


def is_transient_local(profiles: Iterable[object]) -> bool:
    """Whether any of ``profiles`` keeps its last messages for late subscribers."""
    return any(
        isinstance(profile, Qos) and profile.durability is QosDurability.TRANSIENT_LOCAL
        for profile in profiles
    )


def qos_in_words(profiles: Iterable[object]) -> str:
    """The offered ``profiles`` as in ``reliable, volatile, keep last 10``, each kind once."""
    words = (_in_words(profile) for profile in profiles if isinstance(profile, Qos))
    return " or ".join(dict.fromkeys(words))


def _in_words(profile: Qos) -> str:
    history = _word(profile.history)
    if profile.history is QosHistory.KEEP_LAST and profile.depth:
        history += f" {profile.depth}"
    return f"{_word(profile.reliability)}, {_word(profile.durability)}, {history}"


def _word(policy: Enum) -> str:
    return policy.name.lower().replace("_", " ")
