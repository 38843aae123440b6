# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Each file of ``benchmarks`` with the options of its smallest case, by what it needs."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

from forked_python import inherited

FOLDER = Path(__file__).parents[1] / "benchmarks"
TIMEOUT_S = 600

WITH_NOTHING: Mapping[str, str] = {
    "bag_rates": "--gigabytes 0.02",
    "border_crossing": "--side 4 --turns 1",
    "catch_up": "--delays-ms 2",
    "link_throughput": "--only ten --seconds 2.5 --rounds 1",
    "many_recordings": "--recordings 4 --seconds 2",
    "optimizer_speed": "--topics 20 --blocks 5",
    "replay_memory": "--gigabytes 0.02",
    "replay_speed": "--seconds 3 --turns 2",
    "start_up": "--turns 1",
    "throttle_accuracy": "",
    "text_rules": "--side 12 --turns 1",
    "timed_rules": "--side 12 --turns 1",
    "trajectories": "",
}
WITH_ROS: Mapping[str, str] = {
    "bound_cost": "--case orientation --seconds 0.5 --windows 1",
    "incident_cost": "--minutes 0.05",
    "large_images": "--seconds 1 --reliable",
    "live_cost": "--case 'Imu 200 → 50' --seconds 0.5",
    "live_idle": "--seconds 0.5 --rounds 1",
    "live_memory": "--seconds 11",
    "many_rules": "--rules 50 --seconds 1 --windows 1 --reloads 1",
    "relay_paths": "--case 'Imu 200 → 50 Hz' --seconds 0.5 --windows 1",
    "ruler_live": "--minutes 0.1",
}
WITH_CHROMIUM: Mapping[str, str] = {"ruler_typing": "--rules 10 --turns 1"}
WITH_ROS_AND_CHROMIUM: Mapping[str, str] = {"ruler_page": "--seconds 0"}
WITH_NAMESPACES: Mapping[str, str] = {
    "link_ages": "--only thin --contender testudo --longer 0.2",
    "radio_links": "--only wifi-walls --contender testudo --seconds 5",
}
SMALLEST = {**WITH_NOTHING, **WITH_ROS, **WITH_CHROMIUM, **WITH_ROS_AND_CHROMIUM, **WITH_NAMESPACES}


def ends_well(name: str, *options: str) -> None:
    """Fail unless the smallest case of a benchmark prints something and ends with 0."""
    command = [sys.executable, str(FOLDER / f"{name}.py"), *shlex.split(SMALLEST[name]), *options]
    ended = subprocess.run(
        command, capture_output=True, text=True, env=inherited(os.environ), timeout=TIMEOUT_S, check=False
    )
    said = ended.stdout + ended.stderr
    assert ended.returncode == 0, said
    assert ended.stdout, said
    assert "Traceback" not in said, said
