# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How far a part of the tests is, a line from time to time in place of a dot for each test."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence

import pytest

SECONDS_A_LINE = 15.0


class Progress:
    """Counts the tests of the part ``name``, and names each that fails at once."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._begun_s = self._said_s = 0.0
        self._total = 0
        self._done = 0
        self._failed = 0

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        self._begin(self._total or len(session.items))

    @pytest.hookimpl(optionalhook=True)
    def pytest_xdist_node_collection_finished(self, ids: Sequence[str]) -> None:
        """All workers collect the same tests."""
        self._begin(len(ids))

    def _begin(self, total: int) -> None:
        self._total = total
        self._begun_s = self._said_s = time.monotonic()

    def pytest_report_teststatus(self, report: pytest.TestReport) -> tuple[str, str, str] | None:
        """No letter for a test that passed."""
        return ("passed", "", "") if report.passed and report.when == "call" else None

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self._failed += 1
            self._say(f"FAILED {report.nodeid} ({report.when})")
        if report.when == "teardown":
            self._done += 1
            if time.monotonic() - self._said_s >= SECONDS_A_LINE:
                self._said_s = time.monotonic()
                self._say(self._how_far())

    def _how_far(self) -> str:
        left_s = (time.monotonic() - self._begun_s) * (self._total / self._done - 1)
        failed = f", {self._failed} failed" if self._failed else ""
        return f"{self._done} of {self._total} tests{failed}, about {left_s / 60:.1f} min left"

    def _say(self, words: str) -> None:
        # What a part prints goes to a file, how far it is to the terminal.
        sys.stderr.write(f"{self._name:8}  {words}\n")
        sys.stderr.flush()
