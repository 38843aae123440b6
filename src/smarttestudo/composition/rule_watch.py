# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reads the rule files of a live run whenever they change, beside the relays."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue

from smarttestudo.adapters.files.file_states import FileStates
from smarttestudo.composition.live_rules import LiveRuleFiles, Reading

LOOK_PERIOD_S = 0.25


class RuleWatch:
    """Looks at the files every ``LOOK_PERIOD_S`` and reads them once a change has been there for two looks.

    ``last`` was read before.
    So an editor that empties a file and then writes it is mostly not caught halfway.
    """

    def __init__(self, files: LiveRuleFiles, last: Reading) -> None:
        self._files = files
        self._readings: SimpleQueue[Reading] = SimpleQueue()
        self._ended = threading.Event()
        self._read: FileStates | None = last.states
        self._seen = self._read

    def read_soon(self) -> None:
        """Read the files at the next look, changed or not."""
        self._read = None

    def take(self) -> Iterator[Reading]:
        """What was read since the last call, in order."""
        with suppress(Empty):
            while True:
                yield self._readings.get_nowait()

    @contextmanager
    def running(self) -> Iterator[None]:
        """Watch during the block."""
        thread = threading.Thread(target=self._watch, name="rule files", daemon=True)
        thread.start()
        try:
            yield
        finally:
            self._ended.set()
            thread.join()

    def _watch(self) -> None:
        while not self._ended.wait(LOOK_PERIOD_S):
            if self._has_settled(self._files.states()):
                self._readings.put(self._files.read())

    def _has_settled(self, now: FileStates) -> bool:
        before, self._seen = self._seen, now
        if now == self._read or now != before:
            return False
        self._read = now
        return True
