# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from smarttestudo.cli.finding_text import finding_lines
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.finding import Finding, Severity
from smarttestudo.domain.source import Span

NAME = "n" * 1_000_000


def test_a_message_about_a_name_of_a_megabyte_is_a_line() -> None:
    error = TestudoError(f"the topic {NAME} is twice in it", place="a.mcap", remedy="name it once")
    finding = Finding(
        code="a",
        severity=Severity.ERROR,
        message=f"the rule {NAME} is twice in it",
        path="a.adirf",
        span=Span(line=1, column=1, end_line=1, end_column=2),
        hint=f"name {NAME} once",
    )
    for line in (str(error), *finding_lines(finding, ["text"])):
        assert len(line) < 1200
    assert str(error).startswith("a.mcap: error: the topic nnn")
    assert str(error).endswith("nnn is twice in it; name it once")
