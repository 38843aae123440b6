# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a process loses that is killed while it records."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
import time
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from random import Random

import pytest

from incidents.folder_runs import record_of
from incidents.test_killed import LOST_NS, completed_as_left, messages_in
from link.zenoh.ends import until
from smarttestudo.domain.errors import RecordingError

SCRIPT = Path(__file__).with_name("writing_process.py")
LAST_NS = 2 * LOST_NS
ATTEMPTS = 20


def kill_after(folder: Path, log: Path, seconds: float) -> int:
    """Have a process record so long, and a message at least; the monotonic time, in ns, of its end."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    command = [sys.executable, str(SCRIPT), str(folder), str(log)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == b"ready\n"
            time.sleep(seconds)
            until(lambda: any(map(has_message, folder.glob(".*.partial"))))
        finally:
            killed_ns = time.monotonic_ns()
            process.kill()
    return killed_ns


def kept_pace(given: Sequence[tuple[int, int, int]], killed_ns: int) -> bool:
    """Whether the process stood still for no longer than it may lose, in its last second."""
    moments_ns = [*(at_ns for _, _, at_ns in given), killed_ns]
    gaps_ns = [after - before for before, after in pairwise(moments_ns) if after > killed_ns - LAST_NS]
    return max(gaps_ns) < LOST_NS // 4


def killed_at_pace(folder: Path, seconds: float) -> tuple[Path, int, list[tuple[int, int, int]]]:
    """The folder of a process that was killed while the machine kept up, when that was, and its log."""
    for attempt in range(ATTEMPTS):
        incidents, log = folder / f"incidents{attempt}", folder / f"log{attempt}"
        killed_ns = kill_after(incidents, log, seconds)
        given = list(struct.iter_unpack("<QQQ", log.read_bytes()))
        if kept_pace(given, killed_ns):
            return incidents, killed_ns, given
    pytest.fail("machine too slow: the process stood still each time, and what it had then is not claimed")


def has_message(bag: Path) -> bool:
    """Whether a message can be read of a folder that the process writes, and may end meanwhile."""
    try:
        return bool(messages_in(bag))
    except (FileNotFoundError, RecordingError):
        return False


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.contract
def test_a_killed_process_loses_the_last_half_second_at_most(tmp_path: Path, seed: int) -> None:
    folder, killed_ns, given = killed_at_pace(tmp_path, Random(seed).uniform(0.4, 1.6))
    sure = [(number, stamp_ns) for number, stamp_ns, at_ns in given if at_ns < killed_ns - LOST_NS]
    left = {path.name[1:-8]: messages_in(path) for path in folder.glob(".*.partial")}
    assert left
    for name, found in completed_as_left(folder, left, given[-1][1] - LOST_NS).items():
        to_ns = record_of(folder / name)["to_ns"]
        assert found[-1] >= max((number for number, stamp_ns in sure if stamp_ns <= to_ns), default=0)
