# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Small recordings of a fleet: robots that drive along y, each a little faster than the one before."""

from __future__ import annotations

from pathlib import Path

from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import (
    IMAGE,
    ODOM,
    SCAN,
    START_NS,
    BagContent,
    BagMessage,
    cdr,
    message_of,
    odometry,
    write_bag,
)

DAY_NS = 24 * 3600 * 1_000_000_000


def day_of(robot: int, day: int, *, every: int = 1) -> BagContent:
    """Half a second of a day, of which every ``every``-th message is there."""
    start_ns = START_NS + day * DAY_NS
    scan, image = (cdr(topic.type_name, message_of(topic.type_name)) for topic in (SCAN, IMAGE))
    messages = []
    for number in range(0, 20, every):
        stamp_ns = start_ns + number * 25_000_000
        messages += [
            BagMessage(ODOM.name, stamp_ns, odometry(0.0, number * (robot + 1) / 40)),
            BagMessage(SCAN.name, stamp_ns + 1, scan),
            BagMessage(IMAGE.name, stamp_ns + 2, image + bytes(100 * robot)),
        ]
    return BagContent((ODOM, SCAN, IMAGE), tuple(messages))


def write_fleet(folder: Path, *, robots: int, days: int, every: int = 1) -> Path:
    """``folder/ROBOT/DAY``."""
    for robot in range(robots):
        (folder / f"r{robot}").mkdir(parents=True)
        for day in range(days):
            content = day_of(robot, day, every=every)
            write_bag(folder / f"r{robot}" / f"{day:02}", content, storage=StoragePlugin.MCAP)
    return folder
