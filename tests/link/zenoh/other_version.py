# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's end that speaks another version, in a process of its own; it prints what a user has to know.

usage: python -m link.zenoh.other_version VERSION NAME ENDPOINT
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robot.status.statuses import STATUS
from smarttestudo.domain.record import to_json
from smarttestudo.link.protocol import wire
from smarttestudo.link.zenoh import open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions

_FOLDERS = (Path(__file__).parents[2], Path(__file__).parents[3] / "src")


@contextmanager
def robot_of_version(version: int, name: str, endpoint: str) -> Iterator[list[str]]:
    """What a robot that speaks ``version`` has said so far."""
    said: list[str] = []
    process = subprocess.Popen(
        [sys.executable, "-m", "link.zenoh.other_version", str(version), name, endpoint],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, _FOLDERS))},
    )

    def listen() -> None:
        assert process.stdout is not None
        said.extend(line.strip() for line in process.stdout)

    reader = threading.Thread(target=listen, daemon=True)
    reader.start()
    with process:
        try:
            yield said
        finally:
            assert process.stdin is not None
            process.stdin.close()
            reader.join()


def main() -> None:
    """Tell statuses until the standard input ends."""
    version, name, endpoint = sys.argv[1:]
    wire.WIRE_VERSION = int(version)
    ended = threading.Event()

    def wait() -> None:
        sys.stdin.read()
        ended.set()

    threading.Thread(target=wait, daemon=True).start()

    def say(sentence: str) -> None:
        sys.stdout.write(sentence + "\n")
        sys.stdout.flush()

    with open_robot_end(name, LinkOptions(connect=(endpoint,)), say) as end:
        end.offer_incidents(Path("nowhere"))
        while not ended.wait(0.1):
            end.tell(to_json(STATUS))


if __name__ == "__main__":
    main()
