# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The time of ``testudo bag loss`` over many recordings with two workers and with one, and its memory.

Run it with ``python benchmarks/many_recordings.py [--recordings 200] [--seconds 60] [--folder DIR]`` on a
machine that does nothing else. CPU, of all processes together, is comparable on a loaded machine as well.
Memory is that of the largest process, over all recordings and over a tenth of them.
"""

from __future__ import annotations

import argparse
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.recording import Channel, Storage

NS_PER_S = 1_000_000_000
TOPICS = [Channel(topic=f"/point_{number}", type_name="geometry_msgs/msg/Point") for number in range(4)]
HZ = 25
COMMAND = [sys.executable, "-m", "smarttestudo", "bag", "loss", "--json"]


class Run(NamedTuple):
    """Seconds from start to end and of CPU, the most memory of a process in MB of 10⁶ bytes, and output."""

    wall_s: float
    cpu_s: float
    peak_mb: float
    printed: bytes


def write_recording(path: Path, seconds: float) -> None:
    """Points that go in circles."""
    with create_recording(path, storage=Storage.MCAP) as writer:
        for number in range(round(seconds * HZ)):
            angle = number / HZ
            payload = b"\x00\x01\x00\x00" + struct.pack("<3d", math.cos(angle), math.sin(angle), angle)
            for channel in TOPICS:
                writer.write(channel, number * NS_PER_S // HZ, payload)


def run(bags: Path, workers: int) -> Run:
    """Measure ``bags`` in processes of their own."""
    with tempfile.TemporaryFile() as printed:
        started_s = time.perf_counter()
        process = subprocess.Popen([*COMMAND, str(bags), "--workers", str(workers)], stdout=printed)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        wall_s = time.perf_counter() - started_s
        assert process.returncode == 0
        printed.seek(0)
        return Run(
            wall_s=wall_s,
            cpu_s=used.ru_utime + used.ru_stime,
            peak_mb=used.ru_maxrss * 1024 / 1e6,
            printed=printed.read(),
        )


def main() -> None:
    """Print both."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recordings", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--folder", type=Path, help="where there is room for it")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="testudo-benchmark-", dir=arguments.folder) as folder:
        many, few = Path(folder, "many"), Path(folder, "few")
        write_recording(many / "0000", arguments.seconds)
        for number in range(1, arguments.recordings):
            shutil.copytree(many / "0000", many / f"{number:04}")
        few.mkdir()
        for bag in sorted(many.iterdir())[: max(2, arguments.recordings // 10)]:
            (few / bag.name).symlink_to(bag)
        one, two, tenth = run(many, 1), run(many, 2), run(few, 2)
    assert one.printed == two.printed
    print(
        f"{arguments.recordings} recordings of {arguments.seconds:g} s: one worker {one.wall_s:.1f} s, "
        f"two {two.wall_s:.1f} s: {one.wall_s / two.wall_s:.2f} times as fast (aim: 1.7), "
        f"{two.cpu_s:.1f} s of CPU against {one.cpu_s:.1f} s: {two.cpu_s / one.cpu_s:.2f} times "
        f"(aim: at most 1.1); {two.peak_mb:.1f} MB, over a tenth of them {tenth.peak_mb:.1f} MB: "
        f"{two.peak_mb / tenth.peak_mb:.2f} times (aim: at most 1.1)"
    )


if __name__ == "__main__":
    main()
