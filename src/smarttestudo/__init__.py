# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""SmartTestudo: adaptive monitoring for ROS 2 robots.

What scripts and notebooks call is imported when it is first used: a robot lacks the packages that it needs.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from smarttestudo.api import (
        check_rules,
        measure_bag,
        measure_loss,
        read_decisions,
        read_rules,
        replay,
        rows,
    )

__version__ = "0.1.0"

__all__ = [
    "__version__",
    "check_rules",
    "measure_bag",
    "measure_loss",
    "read_decisions",
    "read_rules",
    "replay",
    "rows",
]


def __getattr__(name: str) -> object:
    """The function ``name`` of ``smarttestudo.api``.

    Raises ``MissingPackageError`` where a package of the extra ``studio`` is not installed.
    """
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from smarttestudo.domain.errors import missing_package  # noqa: PLC0415  see above

    try:
        return getattr(import_module("smarttestudo.api"), name)
    except ModuleNotFoundError as error:
        missing = missing_package(error, f"{__name__}.{name}")
        if missing is None:
            raise
        raise missing from error


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
