# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The CPU time that commands take to start.

Run it with ``python benchmarks/start_up.py [--turns 5]``.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

EXAMPLE = Path(__file__).parents[1] / "examples" / "warehouse.adirf"
TESTUDO = ("-m", "smarttestudo")
COMMANDS = {
    "--version": (*TESTUDO, "--version"),
    "check of one file": (*TESTUDO, "check", str(EXAMPLE)),
    "optimize --help": (*TESTUDO, "optimize", "--help"),
    "replay --help": (*TESTUDO, "replay", "--help"),
    "run --help": (*TESTUDO, "run", "--help"),
}
TARGET_S = 1.0
"""Of each, on two cores."""


def cpu_s(command: Sequence[str]) -> float:
    """The CPU time of one process of Python with these arguments."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *command], stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print the medians."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--turns", type=int, default=5)
    arguments = parser.parse_args()
    for name, command in COMMANDS.items():
        # The first may compile modules.
        cpu_s(command)
        taken_s = statistics.median(cpu_s(command) for _ in range(arguments.turns))
        print(f"testudo {name}: {1000 * taken_s:.0f} ms of CPU (target: at most {1000 * TARGET_S:.0f})")


if __name__ == "__main__":
    main()
