# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""No command writes over what it reads, over another of its outputs, or into a recording."""

from __future__ import annotations

from pathlib import Path

import pytest

from bags.bag_factory import small_mission, write_bag
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import UsageError
from smarttestudo.files.outputs import require_separate

RULES = "begin\n  SetFrequency /odom 5\nend\n"
PROFILE = 'budget_kb_per_s = 100\n[topics."/odom"]\nmessage_kb = 0.7\nsource_hz = 20\n'


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a recording, rules, a profile and decisions, all of which commands can read."""
    write_bag(tmp_path / "sq", small_mission())
    (tmp_path / "rules").mkdir()
    (tmp_path / "rules" / "a.adirf").write_text(RULES)
    (tmp_path / "link.adirf").symlink_to("rules/a.adirf")
    (tmp_path / "hard.adirf").hardlink_to(tmp_path / "rules" / "a.adirf")
    (tmp_path / "p.toml").write_text(PROFILE)
    (tmp_path / "d.jsonl").write_text("")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def content_of(folder: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


REPLAY = ("replay", "sq", "--rules", "rules", "--output", "new")


@pytest.mark.parametrize(
    ("command", "line"),
    [
        (("bag", "report", "sq", "-o", "sq/sq.db3"), "--output: error: sq/sq.db3 lies in sq, which is read"),
        (("bag", "report", "sq/sq.db3", "-o", "sq/sq.db3"), "--output: error: sq/sq.db3 is read by this"),
        (("bag", "report", "sq/sq.db3", "-o", "sq/new.html"), "--output: error: sq/new.html lies in the rec"),
        (("bag", "report", "sq", "--profile", "p.toml", "-o", "./p.toml"), "--output: error: p.toml is read"),
        (
            ("bag", "report", "sq", "--decisions", "d.jsonl", "-o", "d.jsonl"),
            "--output: error: d.jsonl is re",
        ),
        (
            ("bag", "report", "sq", "-o", "f/rates.png", "--figures", "f"),
            "--figures: error: f/rates.png is also w",
        ),
        (
            ("bag", "rates", "sq", "--figures", "sq"),
            "--figures: error: sq/rates.png lies in sq, which is rea",
        ),
        (("bag", "compare", "sq", "sq", "--figures", "sq/f"), "--figures: error: sq/f/rates.png lies in sq"),
        ((*REPLAY, "--decisions", "rules/a.adirf"), "--decisions: error: rules/a.adirf is read by this comm"),
        ((*REPLAY, "--decisions", "link.adirf"), "--decisions: error: link.adirf is read by this command"),
        ((*REPLAY, "--decisions", "hard.adirf"), "--decisions: error: hard.adirf is read by this command"),
        (
            (*REPLAY, "--decisions", "x", "--report", "x"),
            "--report: error: x is also written by --decisions",
        ),
        ((*REPLAY, "--report", "sq"), "--report: error: sq is read by this command; name another output"),
        ((*REPLAY, "--report", "new"), "--report: error: new is also written by --output"),
        ((*REPLAY, "--report", "sq/metadata.yaml"), "--report: error: sq/metadata.yaml lies in sq, which is"),
        ((*REPLAY[:-1], "sq/new"), "--output: error: sq/new lies in sq, which is read by this command"),
        (
            ("optimize", "link.adirf", "--profile", "p.toml", "-o", "p.toml"),
            "--output: error: p.toml is read",
        ),
        (
            ("optimize", "link.adirf", "--profile", "p.toml", "-o", "hard.adirf"),
            "--output: error: hard.adirf",
        ),
        (
            ("profile", "--bag", "sq", "-o", "sq/p.toml"),
            "--output: error: sq/p.toml lies in sq, which is rea",
        ),
        (("demo", "--out", "sq/demo"), "--out: error: sq/demo lies in the recording "),
    ],
)
def test_an_output_that_would_cost_something_is_refused_in_one_line(
    desk: Path, capsys: pytest.CaptureFixture[str], command: tuple[str, ...], line: str
) -> None:
    before = content_of(desk)
    assert main(command) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith(line)
    assert captured.err.count("\n") == 1
    assert content_of(desk) == before


@pytest.mark.full
def test_outputs_beside_the_inputs_are_written(desk: Path) -> None:
    assert main((*REPLAY, "--decisions", "rules/d.jsonl", "--report", "r.html")) == 0
    assert main(("bag", "report", "sq", "new", "-o", "f.html", "--figures", "figures")) == 0
    assert main(("optimize", "link.adirf", "--profile", "p.toml", "-o", "rules/b.adirf")) == 0
    assert (desk / "rules" / "b.adirf").exists()


def test_a_log_beside_a_database_belongs_to_it(tmp_path: Path) -> None:
    database = tmp_path / "a.db3"
    database.touch()
    with pytest.raises(UsageError, match=r"a\.db3-wal belongs to .*a\.db3, which is read by this command"):
        require_separate({"-o": tmp_path / "a.db3-wal"}, [database])


def test_devices_may_be_written_to_twice() -> None:
    require_separate({"--decisions": Path("/dev/null"), "--report": Path("/dev/null")})
