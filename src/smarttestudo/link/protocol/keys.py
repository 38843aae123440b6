# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The names under which robots are found on a link."""

from __future__ import annotations

import re
from typing import NamedTuple

from smarttestudo.domain.errors import UsageError

MAX_ROBOTS = 256
"""How many robots an operator's end hears."""
ALL_BOOTS = "testudo/*/*"
ALL_DATA = "testudo/*/*/data"
ALL_STATUSES = "testudo/*/*/status"
ALL_ACCEPTS = "testudo/*/*/accepts"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}", re.ASCII)
_KEY = re.compile(rf"testudo/({_NAME.pattern})/([0-9a-f]{{16}})(/data|/status|/accepts)?", re.ASCII)


class Boot(NamedTuple):
    """One run of the robot's end: the robot's name, and a random number in 16 hexadecimal digits."""

    robot: str
    number: str

    @property
    def key(self) -> str:
        """The key of its liveliness token."""
        return f"testudo/{self.robot}/{self.number}"

    @property
    def data_key(self) -> str:
        """Where the robot's end sends chunks."""
        return f"{self.key}/data"

    @property
    def report_key(self) -> str:
        """Where the operator's end sends reports."""
        return f"{self.key}/report"

    @property
    def status_key(self) -> str:
        """Where the robot's end sends statuses, and gives full ones to those who ask."""
        return f"{self.key}/status"

    @property
    def get_key(self) -> str:
        """Where the robot's end takes questions that change nothing."""
        return f"{self.key}/get"

    @property
    def set_key(self) -> str:
        """Where the robot's end takes questions that change something."""
        return f"{self.key}/set"

    @property
    def incidents_key(self) -> str:
        """Where the robot's end takes questions about its incidents."""
        return f"{self.key}/incidents"

    @property
    def command_key(self) -> str:
        """Where an operator's end sends messages of topics that the robot accepts."""
        return f"{self.key}/command"

    @property
    def datagrams_key(self) -> str:
        """Where the robot's end gives a key for datagrams."""
        return f"{self.key}/datagrams"

    @property
    def accepts_key(self) -> str:
        """Where the robot's end tells what it accepts."""
        return f"{self.key}/accepts"


def boot_of(key: str) -> Boot | None:
    """The boot of a ``key``, ``data_key``, ``status_key`` or ``accepts_key``; ``None`` for other keys."""
    found = _KEY.fullmatch(key)
    return Boot(found[1], found[2]) if found else None


def new_boot(robot: str, number: int) -> Boot:
    """A run of the robot's end. Raises ``UsageError`` for a name that cannot be part of a key."""
    if not _NAME.fullmatch(robot):
        raise UsageError(
            f"{robot[:80]!r} cannot be a robot's name on a link",
            place="--robot",
            remedy="use at most 64 letters, digits and any of _ . - after the first",
        )
    return Boot(robot, f"{number:016x}")
