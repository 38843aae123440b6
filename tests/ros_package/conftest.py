# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from pathlib import Path

import pytest

from made_once import made_once
from ros.conftest import data_path, domain, robot
from ros_package.workspace import INSTALLED, build

__all__ = ["data_path", "domain", "robot"]


@pytest.fixture(scope="session")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made_once(tmp_path_factory, "workspace", build) / INSTALLED


@pytest.fixture(scope="session")
def linked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built with ``--symlink-install``, where edits of the source need no new build."""

    def build_linked(workspace: Path) -> None:
        build(workspace, "--symlink-install")

    return made_once(tmp_path_factory, "linked-workspace", build_linked) / INSTALLED
