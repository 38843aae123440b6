# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings during which the clock was set back are read by stamps, with a note."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import (
    ODOM,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    odometry,
    write_bag,
    write_split_bag,
)
from smarttestudo.bags.measure import measure_bag

S = 1_000_000_000
POSE = BagTopic("/pose", ODOM.type_name)
PAYLOAD = odometry(0.0, 0.0)


def notices_of(folder: Path, storage: StoragePlugin, messages: Iterable[tuple[BagTopic, int]]) -> list[str]:
    written = tuple(BagMessage(topic.name, stamp_ns, PAYLOAD) for topic, stamp_ns in messages)
    write_bag(folder, BagContent((ODOM, POSE), written), storage=storage)
    return [*measure_bag(folder, lambda _: None).notices]


@pytest.mark.parametrize("storage", StoragePlugin)
@pytest.mark.parametrize(("count", "back_s"), [(300, 10), (12_000, 100), (300, 10_000)])
def test_a_clock_that_was_set_back_is_noted_once(
    tmp_path: Path, storage: StoragePlugin, count: int, back_s: int
) -> None:
    stamps_ns = [
        START_NS + number * S // 10 - (back_s * S if number >= count // 3 else 0) for number in range(count)
    ]
    (notice,) = notices_of(tmp_path / "bag", storage, ((ODOM, stamp_ns) for stamp_ns in stamps_ns))
    assert f"stamps go back by up to {back_s - 0.1:.1f} s, as where a clock was set" in notice


@pytest.mark.parametrize("storage", StoragePlugin)
def test_stamps_that_change_places_or_come_topic_by_topic_are_no_set_clock(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    swapped = [(ODOM, START_NS + (number ^ 1) * S // 10) for number in range(300)]
    assert notices_of(tmp_path / "swapped", storage, swapped) == []
    one_by_one = [(topic, START_NS + number * S // 10) for topic in (ODOM, POSE) for number in range(300)]
    assert notices_of(tmp_path / "one_by_one", storage, one_by_one) == []


def split_bag(folder: Path, storage: StoragePlugin, *parts: Iterable[tuple[BagTopic, int]]) -> list[str]:
    contents = [
        BagContent((ODOM, POSE), tuple(BagMessage(topic.name, stamp_ns, PAYLOAD) for topic, stamp_ns in part))
        for part in parts
    ]
    write_split_bag(folder, contents, storage=storage)
    return [*measure_bag(folder, lambda _: None).notices]


@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_clock_that_was_set_back_between_two_files_is_noted_of_the_second(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    parts = [
        [(ODOM, START_NS + start_s * S + number * S // 10) for number in range(300)]
        for start_s in (0, 30, 50)
    ]
    (notice,) = split_bag(tmp_path / "bag", storage, *parts)
    assert Path(notice.split(":", 1)[0]).name.startswith("bag_2.")
    assert "stamps go back by up to 9.9 s, as where a clock was set" in notice


@pytest.mark.parametrize("storage", StoragePlugin)
def test_files_of_different_topics_may_overlap(tmp_path: Path, storage: StoragePlugin) -> None:
    parts = [[(topic, START_NS + number * S // 10) for number in range(300)] for topic in (ODOM, POSE)]
    assert split_bag(tmp_path / "bag", storage, *parts) == []


@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_clock_that_was_set_back_in_and_between_files_is_noted_once_where_it_was_furthest(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    def part(start_s: int, back_s: int) -> list[tuple[BagTopic, int]]:
        return [
            (ODOM, START_NS + start_s * S + number * S // 10 - (back_s * S if number > 100 else 0))
            for number in range(300)
        ]

    parts = [part(100, 5), part(90, 50), part(100, 7)]
    (notice,) = split_bag(tmp_path / "bag", storage, *parts)
    assert Path(notice.split(":", 1)[0]).name.startswith("bag_1.")
    assert "by up to 74.8 s" in notice
