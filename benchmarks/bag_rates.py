# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The time and the peak memory of ``testudo bag rates`` beside reading every message with plain rosbags.

Run it with ``python benchmarks/bag_rates.py [--gigabytes 2] [--image-bytes 6220800] [--folder DIR]``.
It writes an uncompressed sqlite3 bag and an mcap bag with chunks and indexes, one after the other, and has
the system forget what it keeps of them in memory before each reading. At last it cuts each off at 90 %.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from live.large_recording import write_recording
from smarttestudo.domain.recording import Storage

MEMORY = """
import pathlib, re
status = pathlib.Path("/proc/self/status").read_text()
print(re.search(r"VmHWM:\\s+(\\d+) kB", status)[1])
"""
OURS = "import sys; from smarttestudo.cli.main import main; main(['bag', 'rates', '--csv', sys.argv[1]])"
ROSBAGS = """
import sys
from rosbags.rosbag2 import Reader
with Reader(sys.argv[1]) as reader:
    size_bytes = sum(len(payload) for _, _, payload in reader.messages())
"""


class Run(NamedTuple):
    """Seconds from start to end of a process, and the most memory it held, in MB of 10⁶ bytes."""

    wall_s: float
    peak_mb: float


def forget(bag: Path) -> None:
    """Have the system drop the files of ``bag`` from its memory."""
    for path in bag.iterdir():
        with path.open("rb") as file:
            os.fsync(file.fileno())
            os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def cut_off(bag: Path) -> None:
    """Leave 90 % of the bag's one file, as a power cut may."""
    path = next(path for path in bag.iterdir() if path.name != "metadata.yaml")
    os.truncate(path, path.stat().st_size * 9 // 10)


def run(code: str, bag: Path) -> Run:
    """Run ``code`` over ``bag`` in a process of its own."""
    forget(bag)
    started_s = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", code + MEMORY, bag], check=True, capture_output=True, text=True
    )
    wall_s = time.perf_counter() - started_s
    return Run(wall_s=wall_s, peak_mb=int(done.stdout.split()[-1]) * 1024 / 1e6)


def main() -> None:
    """Print both, for both storages."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gigabytes", type=float, default=2.0, help="up to 10 is worth the wait")
    parser.add_argument("--image-bytes", type=int, default=6_220_800)
    parser.add_argument("--folder", type=Path, help="where there is room for it")
    arguments = parser.parse_args()
    for storage in Storage:
        with tempfile.TemporaryDirectory(prefix="testudo-benchmark-", dir=arguments.folder) as folder:
            bag = Path(folder, "large")
            write_recording(bag, storage, round(arguments.gigabytes * 1e9), arguments.image_bytes)
            ours, rosbags = run(OURS, bag), run(ROSBAGS, bag)
            size_gb = sum(path.stat().st_size for path in bag.iterdir()) / 1e9
            cut_off(bag)
            damaged = run(OURS, bag)
        print(
            f"{storage.value}, {size_gb:.1f} GB: rates {ours.wall_s:.2f} s, {ours.peak_mb:.0f} MB; "
            f"rosbags {rosbags.wall_s:.2f} s, {rosbags.peak_mb:.0f} MB; "
            f"1/{rosbags.wall_s / ours.wall_s:.0f} of the time (aim: 1/20, under 200 MB); "
            f"cut off at 90 %: rates {damaged.wall_s:.2f} s, {damaged.peak_mb:.0f} MB",
            flush=True,
        )


if __name__ == "__main__":
    main()
