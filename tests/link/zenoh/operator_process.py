# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An operator's end in a process of its own, which can be killed; it prints what arrives."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

from smarttestudo.domain.link import ReceivedMessage
from smarttestudo.link.zenoh import open_operator_end
from smarttestudo.link.zenoh.security import LinkOptions

_FOLDERS = (Path(__file__).parents[2], Path(__file__).parents[3] / "src")


class OperatorProcess:
    """The process; ``payloads`` are what it has read so far."""

    def __init__(self, endpoint: str) -> None:
        self.payloads: list[bytes] = []
        path = os.pathsep.join(map(str, _FOLDERS))
        self.process = subprocess.Popen(
            [sys.executable, "-m", "link.zenoh.operator_process", endpoint],
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | {"PYTHONPATH": path},
        )
        threading.Thread(target=self._read, daemon=True).start()

    def kill(self) -> None:
        """End it without a chance to say so."""
        self.process.kill()
        self.process.wait()

    def _read(self) -> None:
        assert self.process.stdout is not None
        with self.process.stdout as lines:
            for line in lines:
                self.payloads.append(bytes.fromhex(line))


def main() -> None:
    """Print what arrives, until somebody ends the process."""
    with open_operator_end(LinkOptions(listen=(sys.argv[1],)), print) as end:
        while True:
            for event in end.wait(1.0):
                if isinstance(event, ReceivedMessage):
                    sys.stdout.write(event.payload.hex() + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
