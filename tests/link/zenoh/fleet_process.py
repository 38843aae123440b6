# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A Zenoh router, or a robot's end that publishes 20 times a second, until the standard input ends.

usage: python -m link.zenoh.fleet_process router CONFIG
       python -m link.zenoh.fleet_process robot CONFIG NAME ENDPOINT
"""

from __future__ import annotations

import itertools
import select
import sys
from pathlib import Path

import zenoh

from link.zenoh.ends import ODOM
from smarttestudo.link.zenoh import open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions

PERIOD_S = 0.05


def is_over(timeout_s: float | None = None) -> bool:
    """Whether the standard input ended, after ``timeout_s`` at the latest."""
    readable, _, _ = select.select([sys.stdin], [], [], timeout_s)
    return bool(readable)


def warn(text: str) -> None:
    """Have it beside what else is printed."""
    sys.stderr.write(f"{text}\n")


def route(config: Path) -> None:
    """Route what others send."""
    with zenoh.open(zenoh.Config.from_file(str(config))):
        sys.stdout.write("routing\n")
        sys.stdout.flush()
        is_over()


def publish(config: Path, name: str, endpoint: str) -> None:
    """Publish poses as a robot of that name."""
    options = LinkOptions(connect=(endpoint,), config_file=config)
    with open_robot_end(name, options, warn) as end:
        publisher = end.advertise(ODOM)
        for number in itertools.count():
            publisher.publish(f"{name} {number}".encode())
            if is_over(PERIOD_S):
                return


def main(kind: str, config: str, *robot: str) -> None:
    """Be one of the two."""
    if kind == "router":
        route(Path(config))
    else:
        publish(Path(config), *robot)


if __name__ == "__main__":
    main(*sys.argv[1:])
