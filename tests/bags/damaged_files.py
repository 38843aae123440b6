# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is read of files that are cut or damaged."""

from __future__ import annotations

from pathlib import Path

from bags.bag_factory import BagMessage, small_mission
from bags.bag_reading import ReadBag, read_bag
from smarttestudo.domain.errors import RecordingError

MISSION = small_mission()


def storage_file(folder: Path) -> Path:
    return next(path for path in folder.iterdir() if path.name != "metadata.yaml")


def assert_each_is_an_original_at_most_once(messages: list[BagMessage]) -> None:
    assert len(set(messages)) == len(messages)
    assert set(messages) <= set(MISSION.messages)
    assert [message.stamp_ns for message in messages] == sorted(message.stamp_ns for message in messages)


def read_or_refuse(path: Path) -> ReadBag | RecordingError:
    try:
        return read_bag(path)
    except RecordingError as error:
        return error
