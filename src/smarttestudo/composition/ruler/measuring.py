# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A profile of a bag, as ``testudo profile`` writes it."""

from __future__ import annotations

from pathlib import Path

from smarttestudo.adapters.rosbag import open_recording
from smarttestudo.composition.profile_recording import profile_of_recording


def measured_profile(bag: Path, name: str) -> str:
    """The text of a profile of the bag; ``RecordingError`` where it cannot be read."""
    with open_recording(bag) as recording:
        return profile_of_recording(recording, name=name)
