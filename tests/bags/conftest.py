# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import itertools
from pathlib import Path

import pytest

from bags.bag_factory import KINDS, small_mission, write_split_bag


@pytest.fixture(scope="session", params=list(itertools.product(KINDS, (1, 3))), ids=str)
def bag(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The small mission in one file or in three, stored in each way; whoever changes it puts it back."""
    (storage, compression), files = request.param
    mission = small_mission()
    size = -(-len(mission.messages) // files)
    parts = [mission.between(size * i, size * (i + 1)) for i in range(files)]
    folder = tmp_path_factory.mktemp("bags") / "mission"
    return write_split_bag(folder, parts, storage=storage, compression=compression)
