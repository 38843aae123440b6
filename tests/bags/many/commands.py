# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Commands over recordings, run in the process of a test."""

from __future__ import annotations

import pytest

from report.bag_desk import Ran
from smarttestudo.cli.main import main


class Command:
    """Runs the command in this process."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *arguments: str) -> Ran:
        self._capsys.readouterr()
        code = main(arguments)
        return Ran(code, *self._capsys.readouterr())


COMMANDS = [
    "bag info sent/{}",
    "bag rates sent/{} --latency --topics /odom",
    "bag bandwidth sent/{}",
    "bag compare sent/{} received/{}",
    "bag loss sent/{} received/{} --rules rules.adirf",
    "bag loss sent/{} --topics /odom",
    "bag accuracy sent/{} --rules rules.adirf",
    "replay sent/{} --rules rules.adirf --output out-{}",
]
