# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The packages that a laptop has and a robot may lack."""

from __future__ import annotations

from smarttestudo.domain.errors import TestudoError

STUDIO_PACKAGES = frozenset(
    {
        "apsw",
        "highspy",
        "lz4",
        "matplotlib",
        "mcap",
        "msgspec",
        "numpy",
        "PIL",
        "rich",
        "rosbags",
        "ruamel",
        "starlette",
        "tomlkit",
        "uvicorn",
        "websockets",
        "zstandard",
    }
)
"""What the extra ``studio`` installs, by the names that are imported."""


class MissingPackageError(TestudoError):
    """A package of an extra is not installed."""


def missing_package(error: ModuleNotFoundError, what: str) -> MissingPackageError | None:
    """That ``what`` needs a package of the extra ``studio``; ``None`` where another one is missing."""
    if (error.name or "").partition(".")[0] not in STUDIO_PACKAGES:
        return None
    remedy = "pip install '.[studio]' in the checkout of SmartTestudo"
    return MissingPackageError(f"{what} needs the package {error.name}", remedy=remedy)
