# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The CPU time that commands take to start, beside that of Python alone in the same run.

Run it with ``python benchmarks/start_up.py [--turns 15]``.
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
ALONE = ("-c", "pass")
COMMANDS = {
    "--version": (*TESTUDO, "--version"),
    "check of one file": (*TESTUDO, "check", str(EXAMPLE)),
    "optimize --help": (*TESTUDO, "optimize", "--help"),
    "replay --help": (*TESTUDO, "replay", "--help"),
    "run --help": (*TESTUDO, "run", "--help"),
}
AIM_S = 0.1
"""Of ``--version``."""


def cpu_s(command: Sequence[str]) -> float:
    """The CPU time of one process of Python with these arguments."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *command], stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Print the medians and the ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--turns", type=int, default=15)
    arguments = parser.parse_args()
    every = {"Python alone": ALONE, **COMMANDS}
    for command in every.values():
        # The first may compile modules.
        cpu_s(command)
    times_s = {
        name: statistics.median(each)
        for name, each in zip(
            every,
            zip(*([cpu_s(one) for one in every.values()] for _ in range(arguments.turns)), strict=True),
            strict=True,
        )
    }
    alone_s = times_s.pop("Python alone")
    print(f"Python alone: {1000 * alone_s:.0f} ms of CPU (medians of {arguments.turns} turns)")
    for name, taken_s in times_s.items():
        aim = f" (aim: at most {1000 * AIM_S:g} ms)" if name == "--version" else ""
        print(f"testudo {name}: {1000 * taken_s:.0f} ms, {taken_s / alone_s:.1f} times{aim}")


if __name__ == "__main__":
    main()
