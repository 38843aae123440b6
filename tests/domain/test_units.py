# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Terminal, report and page spell a number alike: the page is tested with the same table."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from smarttestudo.domain.units import grouped
from smarttestudo.optimizer.wording import kb_text
from smarttestudo.report.table import format_number, percent_number

TABLE = json.loads((Path(__file__).parents[1] / "golden" / "numbers.json").read_text("utf-8"))


@pytest.mark.parametrize(("value", "text"), TABLE["kilobytes"])
def test_kilobytes_have_at_most_two_decimals(value: float, text: str) -> None:
    assert kb_text(value) == text


@pytest.mark.parametrize(("value", "decimals", "text"), TABLE["fixed"])
def test_a_number_in_a_table_has_its_decimals_and_thousands_apart(
    value: float, decimals: int, text: str
) -> None:
    assert format_number(value, decimals) == text
    assert grouped(abs(value), decimals) == text.removeprefix("−")


@pytest.mark.parametrize(("value", "decimals", "text"), TABLE["percent"])
def test_percent_read_as_0_or_100_only_where_they_are_that(value: float, decimals: int, text: str) -> None:
    assert percent_number(value, decimals=decimals) == text
