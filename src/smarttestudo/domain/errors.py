# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The one root of every error that a user can meet, and how to get a package that is missing."""

from __future__ import annotations

import platform
import shlex
import sys
from enum import Enum

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
    """The link to an operator or a robot cannot be opened, or what arrived over it is not understood."""


class PortError(TestudoError):
    """An address that cannot be listened on."""


class UsageError(TestudoError):
    """A command line that does not fit together; the program exits with 2."""


class Extra(Enum):
    """An extra of the distribution, by its name in pyproject.toml."""

    STUDIO = "studio"
    FLEET = "fleet"
    LINK = "link"
    METRICS = "metrics"
    PHYSICS = "physics"
    ROS = "ros"


_OF_STUDIO = (
    *("apsw", "highspy", "lz4", "matplotlib", "mcap", "msgspec", "numpy", "PIL", "rich", "rosbags"),
    *("ruamel", "starlette", "tomlkit", "uvicorn", "websockets", "zstandard"),
)
_EXTRAS = {
    **dict.fromkeys(_OF_STUDIO, Extra.STUDIO),
    **dict.fromkeys(("zenoh", "foxglove"), Extra.LINK),
    **dict.fromkeys(("dask", "distributed", "fsspec", "s3fs", "pyarrow"), Extra.FLEET),
    "prometheus_client": Extra.METRICS,
    "mujoco": Extra.PHYSICS,
}
"""The extra that installs a package, by the name that is imported."""


class MissingPackageError(TestudoError):
    """A package of an extra is not installed."""


def missing_package(error: ModuleNotFoundError, what: str) -> MissingPackageError | None:
    """That ``what`` needs a package of an extra; ``None`` where no extra is known to install it."""
    package = (error.name or "").partition(".")[0]
    extra = _EXTRAS.get(package)
    if extra is None:
        return None
    return MissingPackageError(f"{what} needs the package {package}", remedy=how_to_install(extra))


def how_to_get_ros() -> str:
    """Remedy where rclpy is missing; the extra ``ros`` is empty where PyPI has no ROS 2."""
    if _is_ros_on_pypi(sys.platform, platform.machine(), sys.version_info[:2]):
        return f"without a ROS 2 installation, {how_to_install(Extra.ROS)}"
    return "the extra ros is empty here: PyPI has ROS 2 for x86-64 Linux and Python before 3.14 only"


def _is_ros_on_pypi(system: str, machine: str, python: tuple[int, ...]) -> bool:
    return system == "linux" and machine == "x86_64" and python < (3, 14)


def how_to_install(extra: Extra) -> str:
    """The command that installs ``extra`` into this Python's environment, or into one made for it.

    Debian's and Ubuntu's own Python takes no packages (PEP 668): what it lacks goes into an environment that
    sees the system's packages, ROS 2 among them.
    """
    if sys.prefix != sys.base_prefix:
        return (
            f"in the checkout of SmartTestudo, run: {shlex.quote(sys.executable)} -m pip install "
            f"'.[{extra.value}]'"
        )
    return (
        "in the checkout of SmartTestudo, run: python3 -m venv --system-site-packages testudo-venv && "
        f"testudo-venv/bin/pip install '.[{extra.value}]'; then use testudo-venv/bin/testudo"
    )
