# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The versions of Fast DDS's middleware that may block for ever."""

from __future__ import annotations

import os
import re
from pathlib import Path

from rclpy.utilities import get_rmw_implementation_identifier

from smarttestudo.domain.errors import RosError

FIRST_WITHOUT_DEADLOCK = (6, 2, 4)
"""Before, a listener and who sets its callback took two locks in opposite order (ros2/rmw_fastrtps#657)."""

# What all its variants have in common, the listeners included.
_PACKAGE = "rmw_fastrtps_shared_cpp"
_VERSION = re.compile(r"<version>\s*(\d+)\.(\d+)\.(\d+)\s*</version>")


def refuse_known_deadlock() -> None:
    """Raise ``RosError`` where setting a callback may block for ever, as far as the version can be seen."""
    if not get_rmw_implementation_identifier().startswith("rmw_fastrtps"):
        return
    version = _installed_version()
    if version is not None and version < FIRST_WITHOUT_DEADLOCK:
        raise RosError(
            f"rmw_fastrtps {_text(version)} may block for ever when it is asked to wake for messages",
            remedy=f"update it to {_text(FIRST_WITHOUT_DEADLOCK)} or later: sudo apt upgrade",
        )


def _installed_version() -> tuple[int, ...] | None:
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        try:
            manifest = Path(prefix, "share", _PACKAGE, "package.xml").read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError):
            continue
        found = _VERSION.search(manifest)
        return tuple(map(int, found.groups())) if found else None
    return None


def _text(version: tuple[int, ...]) -> str:
    return ".".join(map(str, version))
