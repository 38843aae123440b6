# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from pathlib import Path

import pytest

from ros.conftest import domain, robot
from ros_package.workspace import build

__all__ = ["domain", "robot"]


@pytest.fixture(scope="session")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(tmp_path_factory.mktemp("workspace"))


@pytest.fixture(scope="session")
def linked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built with ``--symlink-install``, where edits of the source need no new build."""
    return build(tmp_path_factory.mktemp("workspace"), "--symlink-install")
