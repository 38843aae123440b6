# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics whose source changes while their messages are kept: each message has the type that it came with."""

from __future__ import annotations

from pathlib import Path

from bags.bag_reading import read_bag, read_with_rosbags
from incidents.test_live_outages import types_of
from incidents.test_reloads import TEXT, Run, rules
from robot.status.statuses import STATUS

SCAN = "sensor_msgs/msg/LaserScan"


def test_a_message_from_before_a_change_of_type_has_the_former_type(tmp_path: Path) -> None:
    run = Run(tmp_path, rules('Record "far" /odom /scan Before 3 s After 1 s'))
    with run.part.running():
        run.hear("/scan", SCAN)
        run.send("/scan", bytes([1]))
        run.trigger()
        run.pass_time(1)
        run.send("/scan", bytes([2]))
        run.hear("/scan", TEXT)
        run.send("/scan", bytes([3]))
        run.trigger()
        state = run.part.added_to(STATUS).incidents
        assert state is not None
        assert (state.open, state.further_moments) == (1, 1)
        run.hear("/scan", "sensor_msgs/msg/Image")
        run.pass_time(40)
    expected = {(SCAN, 1), (SCAN, 2), (TEXT, 3)}
    (folder,) = tmp_path.glob("[!.]*")
    assert types_of(folder) == expected
    assert read_bag(folder).notices == []
    assert read_with_rosbags(folder) == read_bag(folder).messages
    metadata = (folder / "metadata.yaml").read_text()
    assert (SCAN in metadata, TEXT in metadata, "Image" in metadata) == (True, True, False)


def test_a_topic_that_nobody_sent_on_is_listed_with_the_type_that_it_has(tmp_path: Path) -> None:
    run = Run(tmp_path, rules('Record "far" /odom /scan Before 3 s After 1 s'))
    with run.part.running():
        run.hear("/scan", SCAN)
        run.trigger()
        run.pass_time(20)
    assert run.record()["topics"]["/scan"] == {"type": SCAN, "messages": 0, "bytes": 0}
    (folder,) = tmp_path.glob("[!.]*")
    assert SCAN in (folder / "metadata.yaml").read_text()
