# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one root of every error that a user can meet."""

from __future__ import annotations

_MOST_CHARACTERS = 1000


class TestudoError(Exception):
    """Something the user can act on: where it is, what is wrong, what to do.

    ``place`` is a file, ``file:line:column`` or topic; ``remedy`` is one sentence without a full stop.
    Third-party errors become one of these at the adapter that met them, with ``raise … from``.
    """

    __test__ = False

    def __init__(self, cause: str, *, place: str | None = None, remedy: str | None = None) -> None:
        super().__init__(cause)
        self.cause = cause
        self.place = place
        self.remedy = remedy

    def __str__(self) -> str:
        """One line: ``place: error: cause; remedy``."""
        cause = shortened(self.cause)
        head = f"{self.place}: error: {cause}" if self.place else f"error: {cause}"
        return f"{head}; {self.remedy}" if self.remedy else head


def shortened(text: str) -> str:
    """``text`` without its middle where it is too long for a message: files name things of any length."""
    half = _MOST_CHARACTERS // 2
    return text if len(text) <= _MOST_CHARACTERS else f"{text[:half]} … {text[-half:]}"


def testudo_error(error: Exception) -> TestudoError:
    """``error`` itself, or one in its place that names its kind, as nobody expected it."""
    if isinstance(error, TestudoError):
        return error
    return TestudoError(" ".join(f"unexpected {type(error).__name__}: {error}".split()))


def error_at(place: str, error: Exception) -> TestudoError:
    """``error``, at ``place`` where it names none."""
    known = testudo_error(error)
    return known if known.place else TestudoError(known.cause, place=place, remedy=known.remedy)


def said(error: Exception) -> str:
    """``error`` as one line for a log."""
    return str(testudo_error(error))


class RuleFileError(TestudoError):
    """A rule file that cannot be read at all, or that has errors where none may be."""


class ProfileError(TestudoError):
    """A profile that cannot be read or holds a wrong value."""


class MissionError(TestudoError):
    """A mission of the simulated robot that cannot be read or driven."""


class RecordingError(TestudoError):
    """A recording that cannot be read or written."""


class RosError(TestudoError):
    """Something that ROS 2 refuses or lacks."""


class LinkError(TestudoError):
    """The link to an operator or a robot cannot be opened, or what came over it is not understood."""


class PortError(TestudoError):
    """An address that cannot be listened on."""


class UsageError(TestudoError):
    """A command line that does not fit together; the program exits with 2."""
