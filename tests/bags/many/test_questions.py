# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The questions of docs/how-to/questions-to-parquet.md have the answers that the commands' own JSON gives."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from datetime import datetime, timedelta, timezone
from pathlib import Path
from statistics import fmean
from typing import Any

import pytest

from bags.many.commands import COMMANDS, Command
from bags.many.fleet_factory import write_fleet
from docs.code_blocks import blocks_of
from smarttestudo.cli.main import main
from smarttestudo.domain.record import column_types
from smarttestudo.report.fleet.numbers import ReportRow

pytestmark = pytest.mark.full

PAGE = "docs/how-to/questions-to-parquet.md"
ROOT = Path(__file__).parents[3]
ROBOTS, DAYS = 2, 8
Documents = Sequence[dict[str, Any]]
Rows = list[tuple[Any, ...]]


@pytest.fixture(scope="module")
def answered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the commands of the page were run."""
    folder = tmp_path_factory.mktemp("questions")
    write_fleet(folder / "fleet", robots=ROBOTS, days=DAYS)
    write_fleet(folder / "received", robots=ROBOTS, days=DAYS, every=4)
    (folder / "rules.adirf").write_text("begin\n    SetFrequency /odom 10\n    SetFrequency /image 5\nend\n")
    (commands,) = [block.commands for block in blocks_of(PAGE) if block.language == "sh"]
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for command in commands:
            program, *arguments = shlex.split(command.partition(" > ")[0])
            assert program == "testudo"
            with Path(command.partition(" > ")[2]).open("w") as file, redirect_stdout(file):
                assert main([*arguments, "--workers", "1"]) == 0
    return folder


def documents(folder: Path, name: str) -> Documents:
    return [json.loads(line) for line in (folder / name).read_text().splitlines()]


def costs(folder: Path) -> Rows:
    messages, size_bytes = Counter[str](), Counter[str]()
    for one in documents(folder, "rates.jsonl"):
        for topic, numbers in one["topics"].items():
            messages[topic] += numbers["messages"]
            size_bytes[topic] += numbers["bytes"]
    return [(topic, messages[topic], size) for topic, size in size_bytes.most_common(3)]


def losses(folder: Path) -> Rows:
    by_robot = defaultdict(list)
    for one in documents(folder, "losses.jsonl"):
        for field in one["fields"]:
            if (field["topic"], field["field"]) == ("/odom", "pose_y"):
                by_robot[one["a"].split("/")[1]].append(field["received"]["hold"])
    rows = [
        (robot, max(one["max"] for one in holds), fmean(one["rmse"] for one in holds))
        for robot, holds in by_robot.items()
    ]
    return sorted(rows, key=lambda row: (-row[1], row[0]))


def savings(folder: Path) -> Rows:
    sums: dict[str, list[float]] = defaultdict(lambda: [0.0, 0.0])
    for one in documents(folder, "replays.jsonl"):
        for topic, numbers in one["topics"].items():
            sums[topic][0] += numbers["in_kb"]
            sums[topic][1] += numbers["out_kb"]
    rows = [(topic, in_kb, out_kb) for topic, (in_kb, out_kb) in sums.items()]
    return sorted(rows, key=lambda row: row[2] - row[1])


def weeks(folder: Path) -> Rows:
    recordings, size_bytes = Counter[datetime](), Counter[datetime]()
    for one in documents(folder, "rates.jsonl"):
        day = datetime.fromtimestamp(one["start_ns"] // 10**9, tz=timezone.utc)
        monday = (day - timedelta(days=day.weekday())).replace(hour=0, minute=0, second=0)
        recordings[monday] += 1
        size_bytes[monday] += one["total"]["bytes"]
    return [(monday, recordings[monday], size_bytes[monday]) for monday in sorted(recordings)]


def newest(folder: Path) -> Rows:
    return [
        (one["bag"], topic, numbers["mean_hz"])
        for one in documents(folder, "rates.jsonl")
        for topic, numbers in sorted(one["topics"].items())
    ]


QUESTIONS: Sequence[Callable[[Path], Rows]] = (costs, losses, savings, weeks, newest)


def ask(sql: str, folder: Path) -> Rows:
    import duckdb  # noqa: PLC0415  only full tests need it

    with duckdb.connect() as database:
        database.execute("SET TimeZone = 'UTC'")
        rows: Rows = database.execute(sql.replace("'numbers/", f"'{folder}/numbers/")).fetchall()
        return rows


@pytest.mark.full
@pytest.mark.parametrize("number", range(len(QUESTIONS)), ids=[one.__name__ for one in QUESTIONS])
def test_a_question_of_the_page_has_the_answer_of_the_json(number: int, answered: Path) -> None:
    asked = [block.text for block in blocks_of(PAGE) if block.language == "sql"]
    assert len(asked) == len(QUESTIONS)
    answers, expected = ask(asked[number], answered), QUESTIONS[number](answered)
    assert len(answers) == len(expected) >= 2
    for answer, row in zip(answers, expected, strict=True):
        assert answer == tuple(
            pytest.approx(cell, rel=1e-12) if isinstance(cell, float) else cell for cell in row
        )


@pytest.mark.full
def test_every_row_is_there_to_the_last_digit(answered: Path) -> None:
    rows = ask("SELECT bag, topic, kb_per_s, jitter_s FROM 'numbers/topics/*.parquet'", answered)
    assert sorted(rows) == sorted(
        (one["bag"], topic, numbers["kb_per_s"], numbers["jitter_s"])
        for one in documents(answered, "rates.jsonl")
        for topic, numbers in one["topics"].items()
    )
    assert len(rows) == ROBOTS * DAYS * 3


def test_runs_that_add_at_once_lose_nothing(answered: Path, tmp_path: Path) -> None:
    options = ("--workers", "1", "--parquet", str(tmp_path))
    command = [sys.executable, "-m", "smarttestudo", "bag", "rates", str(answered / "fleet/r0"), *options]
    started = [subprocess.Popen(command, stdout=subprocess.DEVNULL) for _ in range(3)]
    assert [process.wait() for process in started] == [0] * 3
    rows = ask(
        f"SELECT run, count(*), count(DISTINCT bag) FROM '{tmp_path}/topics/*.parquet' GROUP BY run", tmp_path
    )
    assert [row[1:] for row in rows] == [(DAYS * 3, DAYS)] * 3
    assert {path.suffix for path in (tmp_path / "topics").iterdir()} == {".parquet"}


def columns_on_the_page() -> dict[str, list[str]]:
    page = (ROOT / PAGE).read_text(encoding="utf-8").partition("## The tables")[2]
    rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| `")]
    return {row[0].strip("| `"): [cell.strip("` |") for cell in row[2].split(", ")] for row in rows}


@pytest.mark.parametrize("command", COMMANDS)
def test_the_columns_of_csv_have_the_same_values(command: str, testudo: Command, fleet: Path) -> None:
    arguments = command.replace("{}", "a").split()
    testudo(*arguments, "--parquet", "numbers")
    (folder,) = (fleet / "numbers").iterdir()
    all_of_it = f"SELECT * FROM '{folder}/*.parquet'"
    columns = [name for name, *_ in ask(f"DESCRIBE {all_of_it}", fleet)]
    assert columns == ["run", "written_at", "version", *columns_on_the_page()[folder.name]]
    if arguments[0] == "replay":
        return
    rows = testudo(*arguments, "--csv").csv
    assert [name for name in rows[0] if name not in columns] == []
    shown = [
        {
            name: "" if value is None else str(value)
            for name, value in zip(columns, row, strict=True)
            if name in rows[0]
        }
        for row in ask(all_of_it, fleet)
    ]
    assert shown == rows


def test_the_page_has_every_column_of_reports() -> None:
    assert columns_on_the_page()["reports"] == list(column_types(ReportRow))


def test_tables_are_not_put_into_a_recording(testudo: Command, fleet: Path) -> None:
    ran = testudo("bag", "rates", "sent/a", "--parquet", "sent/a/numbers")
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(
        "--parquet: error: sent/a/numbers lies in sent/a, which is read by this command"
    )


def test_a_folder_that_cannot_be_written_is_one_line(testudo: Command, fleet: Path) -> None:
    (fleet / "file").touch()
    cause = "file: error: the folder cannot be written: a file is there in place of a folder"
    # Of many recordings none is measured in vain.
    for recordings in ("sent/a", "sent"):
        ran = testudo("bag", "rates", recordings, "--parquet", "file")
        assert (ran.code, ran.out) == (1, "")
        assert ran.err == f"{cause}; name another place\n"
