# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The package in a workspace of its own, built as on a robot."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[2]
OF_A_ROS_PACKAGE = ("setup.py", "setup.cfg", "pyproject.toml", "package.xml", "README.md", "LICENSE")
OF_A_ROS_PACKAGE_FOLDERS = (
    "resource",
    "launch",
    "worlds",
    "examples",
    "extras",
    "src",
    "workspace_tests",
)
INSTALLED = Path("install/smarttestudo")
"""Where a workspace has the package, once it is built."""


def build(workspace: Path, *options: str) -> None:
    """``colcon build`` of a copy of what belongs to the package."""
    source = workspace / "src" / "smarttestudo"
    source.mkdir(parents=True)
    for name in OF_A_ROS_PACKAGE:
        shutil.copy(ROOT / name, source)
    for name in OF_A_ROS_PACKAGE_FOLDERS:
        shutil.copytree(
            ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info")
        )
    colcon(workspace, "build", *options)


def colcon_tested(workspace: Path) -> ElementTree.Element:
    """What ``colcon test`` found in a workspace that is built, as JUnit XML."""
    colcon(workspace, "test", "--event-handlers", "console_direct+")
    return ElementTree.parse(workspace / "build" / "smarttestudo" / "pytest.xml").getroot()


def colcon(workspace: Path, verb: str, *options: str) -> None:
    """``colcon`` with the package only, which must succeed."""
    command = [sys.executable, "-m", "colcon", verb, "--packages-select", "smarttestudo", *options]
    done = subprocess.run(command, cwd=workspace, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
