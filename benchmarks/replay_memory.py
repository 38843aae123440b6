# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The peak memory of replaying a large recording with whole camera images.

Run it with ``python benchmarks/replay_memory.py [--gigabytes 5] [--storage sqlite3|mcap] [--folder DIR]``.
It writes the recording first, which takes the disk space twice, and replays it in a process of its own.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from live.contenders import TESTUDO
from live.large_recording import write_recording
from smarttestudo.domain.recording import Storage

IMAGE_BYTES = 6_220_800
AIM_MB = 300
RULES = "begin\nSetFrequency /camera/image_raw {image_hz}\nSetFrequency /imu 10\nend\n"


def peak_mb_of_replay(bag: Path, rules: Path, output: Path, storage: Storage) -> float:
    """The peak resident memory, in MB of 10⁶ bytes, of ``testudo replay`` in a process of its own."""
    command = [sys.executable, "-c", TESTUDO]
    options = ["--rules", str(rules), "--output", str(output), "--storage", storage.value]
    subprocess.run([*command, "replay", str(bag), *options], check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024 / 1e6


def main() -> None:
    """Print the peaks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gigabytes", type=float, default=5.0)
    parser.add_argument("--storage", type=Storage, choices=list(Storage), default=Storage.SQLITE3)
    parser.add_argument("--image-hz", default="3", help="the rate of the images, or Full")
    parser.add_argument("--folder", type=Path, help="where there is room for it")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="testudo-benchmark-", dir=arguments.folder) as folder:
        bag, rules = Path(folder, "large"), Path(folder, "rules.adirf")
        rules.write_text(RULES.format(image_hz=arguments.image_hz))
        images = write_recording(bag, arguments.storage, round(arguments.gigabytes * 1e9), IMAGE_BYTES)
        size_gb = sum(path.stat().st_size for path in bag.iterdir()) / 1e9
        print(f"{size_gb:.2f} GB of {arguments.storage.value}, {images:,} images of 6.2 MB", flush=True)
        started_s = time.perf_counter()
        peak_mb = peak_mb_of_replay(bag, rules, Path(folder, "monitored"), arguments.storage)
        print(f"replayed in {time.perf_counter() - started_s:.0f} s")
    print(f"peak {peak_mb:.0f} MB  (aim: under {AIM_MB} MB)")


if __name__ == "__main__":
    main()
