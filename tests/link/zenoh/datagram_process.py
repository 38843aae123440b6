# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One end of a link between namespaces, in a process of its own, which prints what it sees as JSON.

usage: python -m link.zenoh.datagram_process robot|auto|operator ENDPOINT

``auto`` is a robot that uses datagrams only where packets are lost.
"""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from link.zenoh.ends import ODOM, messages
from smarttestudo.domain.link import LinkNeeds
from smarttestudo.link.zenoh import open_operator_end, open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions
from thin_link.network_namespaces import in_namespace

PERIOD_S = 0.05
EVENTS_EVERY = 4
ODOM_BYTES, EVENT_BYTES = 700, 3_000
_FOLDERS = (
    Path(__file__).parents[2],
    Path(__file__).parents[3] / "src",
    Path(__file__).parents[3] / "benchmarks",
)
EVENTS = replace(ODOM, topic="/events")
"""It is Full."""


@dataclass
class End:
    """What one end said, each with the time of this machine's steady clock, in seconds."""

    process: subprocess.Popen[str]
    said: list[tuple[float, str, Any]] = field(default_factory=list)

    def numbers(self, topic: str) -> list[int]:
        return [number for _, what, number in self.said if what == topic]

    def times_s(self, topic: str) -> list[float]:
        return [at_s for at_s, what, _ in self.said if what == topic]

    def newest(self, what: str) -> Any:
        return next((value for _, one, value in reversed(self.said) if one == what), None)

    def finish(self) -> None:
        """Have it publish nothing more."""
        assert self.process.stdin is not None
        self.process.stdin.close()


@contextmanager
def end_in(namespace: str, role: str, endpoint: str) -> Iterator[End]:
    """One end in a namespace."""
    command = [sys.executable, "-m", "link.zenoh.datagram_process", role, endpoint]
    process = subprocess.Popen(
        in_namespace(namespace, command),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(map(str, _FOLDERS))},
    )
    end = End(process)

    def listen() -> None:
        assert process.stdout is not None
        for line in process.stdout:
            end.said.append(tuple(json.loads(line)))

    reader = threading.Thread(target=listen, daemon=True)
    reader.start()
    with process:
        try:
            yield end
        finally:
            process.terminate()
            reader.join()


def _say(what: str, value: object) -> None:
    sys.stdout.write(json.dumps([time.monotonic(), what, value]) + "\n")
    sys.stdout.flush()


def _message(number: int, size_bytes: int) -> bytes:
    """One that does not become smaller by compression."""
    return number.to_bytes(8, "little") + random.Random(number).randbytes(size_bytes)


def _run_robot(options: LinkOptions, finished: threading.Event) -> None:
    with open_robot_end("r1", options, lambda text: _say("warning", text)) as end:
        end.follow({EVENTS.topic: LinkNeeds(is_full=True)})
        odom, events = end.advertise(ODOM), end.advertise(EVENTS)
        number = 0
        while True:
            if not finished.is_set():
                odom.publish(_message(number, ODOM_BYTES))
                if number % EVENTS_EVERY == 0:
                    events.publish(_message(number // EVENTS_EVERY, EVENT_BYTES))
                    _say("offered", number // EVENTS_EVERY)
                number += 1
            _say("by_datagrams", end.state.by_datagrams)
            time.sleep(PERIOD_S)


def _run_operator(options: LinkOptions) -> None:
    with open_operator_end(options, lambda text: _say("warning", text)) as end:
        while True:
            for message in messages(end.wait(0.05)):
                _say(message.stream.topic, int.from_bytes(message.payload[:8], "little"))


def main() -> None:
    """Publish until the standard input ends, or receive, and go on until somebody ends it."""
    role, endpoint = sys.argv[1:]
    if role == "operator":
        _run_operator(LinkOptions(listen=(endpoint,), insecure=True))
        return
    finished = threading.Event()

    def wait() -> None:
        sys.stdin.read()
        finished.set()

    threading.Thread(target=wait, daemon=True).start()
    options = LinkOptions(connect=(endpoint,), insecure=True, needs_datagrams=role == "robot")
    _run_robot(options, finished)


if __name__ == "__main__":
    main()
