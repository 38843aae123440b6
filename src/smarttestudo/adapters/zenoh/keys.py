# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The names under which robots are found on a link."""

from __future__ import annotations

import re
from typing import NamedTuple

from smarttestudo.domain.errors import UsageError

ALL_BOOTS = "testudo/*/*"
ALL_DATA = "testudo/*/*/data"
_DATA = "/data"
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,63}", re.ASCII)
_KEY = re.compile(rf"testudo/({_NAME.pattern})/([0-9a-f]{{16}})", re.ASCII)


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
        return self.key + _DATA

    @property
    def report_key(self) -> str:
        """Where the operator's end sends reports."""
        return f"{self.key}/report"


def boot_of(key: str) -> Boot | None:
    """What ``Boot.key`` or ``Boot.data_key`` gave ``key`` for; ``None`` for any other."""
    found = _KEY.fullmatch(key.removesuffix(_DATA))
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
