# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The packages that an installation may lack, and the commands that install them."""

from __future__ import annotations

import platform
import shlex
import sys
from enum import Enum

from smarttestudo.domain.errors import TestudoError


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
