# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A relay passes each message that deletes markers, at any rate but Off."""

from __future__ import annotations

import random

import pytest
from rosbags.typesys import Stores

from loop.loop_driver import SECOND, LoopDriver
from pacing.test_stream_reader import Written


@pytest.mark.parametrize("version", [Stores.ROS2_FOXY, Stores.ROS2_JAZZY])
@pytest.mark.parametrize("kind", ["marker", "markers"])
@pytest.mark.parametrize("transient_local", [False, True])
def test_each_deletion_passes(version: Stores, kind: str, transient_local: bool) -> None:
    driver, chance, deletions = LoopDriver("begin SetFrequency /m 0.2 end"), random.Random(1), []
    for number in range(300):
        written = Written(version, chance, ["a"], [2, 3] if number % 50 == 20 else [0, 1])
        type_name, payload, _ = written(kind)
        if not number:
            driver.source("/m", type_name=type_name, transient_local=transient_local)
        at_ns = SECOND + number * SECOND // 10
        driver.send("/m", at_ns, payload)
        deletions += [at_ns] * (written.deletion > 0)
    relayed = driver.stamps_of("/m")
    assert len(deletions) == 6
    assert set(deletions) <= set(relayed)
