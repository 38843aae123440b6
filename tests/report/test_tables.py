# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a user reads in a terminal, a pipe and a file."""

from __future__ import annotations

import io
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from report.demo_like_report import demo_like_report
from report.golden_files import assert_reads_as
from smarttestudo.bags.comparison import Comparison, Target, TopicComparison, compare
from smarttestudo.bags.statistics import TopicStatistics
from smarttestudo.cli.tables import print_table
from smarttestudo.report.comparison_tables import RunNames, bandwidth_table, frequency_table
from smarttestudo.report.table import (
    WHOLE,
    Column,
    Table,
    csv_table,
    format_number,
    markdown_table,
    plain_table,
)

GOLDEN = Path(__file__).parent / "golden"
_ESCAPE_SEQUENCE = re.compile(r"\x1b\[[0-9;]*m")


class Terminal(io.StringIO):
    def __init__(self, encoding: str = "utf-8") -> None:
        super().__init__()
        self._encoding = encoding

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return self._encoding

    def isatty(self) -> bool:
        return True


HALF = TopicStatistics(
    messages=1, size_bytes=1, start_s=0.0, end_s=0.0, mean_hz=None, binned_hz=1.0, kb_per_s=None
)


def one_topic(topic: str) -> Table[TopicComparison]:
    return frequency_table(compare({topic: HALF}, {}, {topic: Target(planned_hz=2.0, attainable_hz=1.0)}))


def shown(table: Table[Any], terminal: Terminal) -> list[str]:
    print_table(table, terminal)
    return _ESCAPE_SEQUENCE.sub("", terminal.getvalue()).splitlines()


@pytest.mark.parametrize("build", [frequency_table, bandwidth_table])
def test_the_demos_tables_read_as_in_the_golden_file(
    build: Callable[[Comparison], Table[TopicComparison]],
) -> None:
    table = plain_table(build(demo_like_report().comparison), width=60)
    assert_reads_as(GOLDEN / f"{build.__name__.removesuffix('_table')}-60.txt", table + "\n")


def test_missing_numbers_exact_means_frames_and_named_runs_read_as_in_the_golden_file() -> None:
    """A dash and no zero; beside an error the mean that it is of; transforms without an error, explained."""
    second = TopicStatistics(
        messages=300, size_bytes=300, start_s=0.0, end_s=99.6, mean_hz=3.002, binned_hz=2.98, kb_per_s=0.003
    )
    halves = compare(
        {"/odom": HALF, "/scan": second},
        {"/scan": second},
        {
            "/odom": Target(planned_hz=2.0, attainable_hz=1.0),
            "/scan": Target(planned_hz=3.0, attainable_hz=3.0),
        },
    )
    frames = compare({"/tf": HALF}, {"/tf": HALF}, {"/tf": Target(planned_hz=2.0, attainable_hz=None)})
    tables = (frequency_table(halves, RunNames(before="monday", after="tuesday")), frequency_table(frames))
    assert_reads_as(GOLDEN / "frequency-cells.txt", "\n\n".join(map(plain_table, tables)) + "\n")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"),
        (float("nan"), "–"),
        (float("-inf"), "–"),
        (-0.001, "0.00"),
        (0.004, "0.00"),
        (-89.6, "−89.60"),
        (180_380.0, "180 380.00"),
    ],
)
def test_numbers_have_a_true_minus_and_no_signed_zero(value: float | None, text: str) -> None:
    assert format_number(value, 2) == text


def test_changes_show_their_sign() -> None:
    assert [format_number(value, 1, signed=True) for value in (18.0, -5.0, 0.0)] == ["+18.0", "−5.0", "0.0"]


names = st.text(st.characters(codec="utf-8"), max_size=40)
rates = st.lists(st.tuples(names, st.none() | st.floats(-1e6, 1e6)), max_size=5)
TOPIC: Column[tuple[str, float | None]] = Column("Topic", "", lambda row: row[0], is_text=True)
RATE: Column[tuple[str, float | None]] = Column("Rate", "Hz", lambda row: row[1])


@given(rates, st.integers(30, 80))
def test_a_table_keeps_to_its_width_and_to_one_line_a_row(
    rows: list[tuple[str, float | None]], width: int
) -> None:
    table = Table(columns=(TOPIC, RATE), rows=rows)
    lines = plain_table(table, width=width).split("\n")
    assert len(lines) == 3 + len(table.rows)
    assert all(len(line) <= width for line in lines)
    for (_, rate), line in zip(table.texts(), lines[3:], strict=True):
        assert line.endswith(rate)


@given(names)
def test_no_name_can_move_the_cursor_or_break_a_line(name: str) -> None:
    line = TOPIC.text(name)
    assert len((line + "|").splitlines()) == 1
    assert not any(ord(one) < 32 or 0x7F <= ord(one) < 0xA0 for one in line)


def test_a_pipe_gets_the_plain_table_whole() -> None:
    pipe = io.StringIO()
    table = bandwidth_table(demo_like_report().comparison)
    print_table(table, pipe)
    assert pipe.getvalue() == plain_table(table) + "\n"


def constant(value: float) -> Callable[[str], float]:
    return lambda _: value


def test_a_column_is_the_same_in_a_terminal_in_markdown_and_in_csv_and_its_sums_stand_at_the_foot() -> None:
    """What is missing is a dash to a reader and empty to a program, which gets numbers in full."""
    table: Table[tuple[str, float | None]] = Table(
        title="Messages",
        columns=(
            Column("Topic", "", lambda row: row[0], is_text=True, sums=("others", "all")),
            Column("Rate", "Hz", lambda row: row[1], sums=(0.125, 4.0)),
            Column("Count", "", lambda row: 1234.5, WHOLE),
        ),
        rows=[("/a|b", 2.0625), ("/c", None)],
        footnotes=("A note.",),
    )
    forms = (plain_table(table), markdown_table(table), csv_table(table))
    assert_reads_as(GOLDEN / "table-forms.txt", "\n\n".join(forms))


def too_wide() -> Table[str]:
    """As ``bag loss`` has them: words and ten numbers, of which the last five belong together."""
    return Table(
        title="Errors of a recording with a name that is longer than its table is wide: rates",
        columns=(
            Column("Field", "", str, is_text=True),
            *(Column(f"Hold{n}", "RMSE", constant(1000.25 + n), heads_group=n == 0) for n in range(5)),
            *(Column(f"Fixed{n}", "hold", constant(1005.25 + n), heads_group=n == 0) for n in range(5)),
        ),
        rows=("/cmd_vel yaw_rate", "/joint_states max_velocity"),
        footnotes=("A note.",),
    )


def test_a_terminal_of_80_columns_shows_every_cell_whole_with_rich_and_without(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A table too wide is shown as several, which begin with what names their rows."""
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("TERM", "xterm-256color")
    comparison = demo_like_report().comparison
    tables: tuple[Table[Any], ...] = (frequency_table(comparison), bandwidth_table(comparison), too_wide())
    with_rich = [line for table in tables for line in shown(table, Terminal())]
    monkeypatch.setitem(sys.modules, "rich.console", None)
    plain = [line for table in tables for line in shown(table, Terminal())]
    assert_reads_as(GOLDEN / "terminal-80.txt", "\n".join(plain) + "\n")
    assert max(map(len, (*with_rich, *plain))) <= 80
    assert words(with_rich) == words(plain)


def words(lines: list[str]) -> list[str]:
    return [word for line in lines for word in line.split() if word.strip("─")]


def test_rich_markup_in_a_name_is_only_text(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    lines = shown(one_topic("/[red]odom[/] :smile:"), Terminal())
    assert any("/[red]odom[/] :smile:" in line for line in lines)


def test_a_terminal_that_knows_only_ascii_gets_ascii(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    lines = shown(one_topic("/ödom"), Terminal("ascii"))
    assert any(line.split() == ["/?dom", "1.00", "-", "-", "2.00", "-", "-"] for line in lines)
    assert all(line.isascii() for line in lines)
