# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Quality-of-service profiles as bags hold them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rosbags.interfaces import Qos, QosDurability
from rosbags.rosbag2.errors import ReaderError
from rosbags.rosbag2.metadata import parse_qos


def read_qos(stored: Any) -> tuple[Qos, ...]:
    """The profiles in an ``offered_qos_profiles`` entry: YAML text up to version 8, a list from 9 on.

    Raises ``ValueError`` for an entry that holds something else.
    """
    try:
        return tuple(parse_qos(stored or []))
    except (ReaderError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError("these are no QoS profiles") from error


class QosColumn:
    """Reads the profiles of one topic after the other; what makes no sense costs a notice."""

    def __init__(self) -> None:
        self.notices: list[str] = []

    def read(self, topic: str, stored: Any) -> tuple[Qos, ...]:
        """The profiles of ``topic``, none where they cannot be read."""
        try:
            return read_qos(stored)
        except ValueError:
            self.notices.append(f"the QoS profiles of {topic} cannot be read and were left out")
            return ()


def is_transient_local(profiles: Iterable[object]) -> bool:
    """Whether any of ``profiles`` keeps its last messages for late subscribers."""
    return any(
        isinstance(profile, Qos) and profile.durability is QosDurability.TRANSIENT_LOCAL
        for profile in profiles
    )
