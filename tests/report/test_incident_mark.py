# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An incident is read like any recording, and says what it is and where in it that happened."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from bags.bag_factory import small_mission, write_bag
from report.golden_files import assert_reads_as, page_lines
from smarttestudo.cli.main import main
from smarttestudo.cli.output import progress
from smarttestudo.report.bag_report import ReportRequest, series_over_time
from smarttestudo.report.figures.charts import bandwidth_figure, rates_figure, total_figure

GOLDEN = Path(__file__).parent / "golden"
RULES = """\
begin
  SetFrequency /odom 5
  Rule "Far" If CheckValue /odom pose_y > 5 Then
    Record "near miss" /odom /scan Before 3 s After 2 s
  EndIf
  Rule "Farther" If CheckValue /odom pose_y > 5.3 Then
    Record "later" /odom /scan Before 3280 ms After 2 s
  EndIf
end
"""


@pytest.fixture(scope="module")
def replayed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("replayed")
    bag, rules = write_bag(folder / "bag", small_mission(10.0)), folder / "rules.adirf"
    rules.write_text(RULES)
    written = ("--output", str(folder / "out"), "--incidents", str(folder / "found"))
    assert main(["replay", str(bag), "--rules", str(rules), *written]) == 0
    return folder


@pytest.fixture
def incident(replayed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An incident as earlier versions wrote it: a file that others shared has more than its window."""
    shutil.copytree(replayed, tmp_path, symlinks=True, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    _, later = sorted(Path("found").iterdir())
    record = json.loads((later / "incident.json").read_text())
    (later / "incident.json").write_text(json.dumps({**record, "from_ns": record["from_ns"] + 280_000_000}))
    return later


def test_a_command_says_which_incident_it_is_and_what_is_odd_about_it(
    incident: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert main(["bag", "rates", str(incident)]) == 0
    printed = capsys.readouterr()
    assert_reads_as(GOLDEN / "incident-rates.txt", printed.out + printed.err)
    for command in ("info", "bandwidth", "compare bag", "loss", "loss bag"):
        action, *others = command.split()
        assert main(["bag", action, str(incident), *others]) == 0
        said = capsys.readouterr().out
        assert "\nincident later at 2" in f"\n{said}"
        assert ": rule Farther, /odom pose_y = 5.32\n" in said


def test_programs_are_told_too(incident: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bag", "rates", str(incident), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["incident"]
    record = json.loads((incident / "incident.json").read_text())
    assert found == {name: record[name] for name in ("name", "rule", "time", "triggered_ns", "values")}


def test_the_report_marks_the_moment_in_each_chart_and_says_it_as_in_the_golden_file(
    incident: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bag", "report", str(incident)]) == 0
    assert_reads_as(GOLDEN / "page-incident.html", page_lines(Path("report.html").read_text("utf-8")))
    assert "the first 0.3 s are from before the window of later" in capsys.readouterr().err


def test_figures_have_a_line_at_the_moment(incident: Path) -> None:
    report = series_over_time(ReportRequest(a=incident, title="", progress=progress))
    assert report.incident is not None
    for figure in (rates_figure(report), bandwidth_figure(report), total_figure(report)):
        assert figure is not None
        for axes in figure.axes:
            places = [
                np.asarray(line.get_xydata())[:, 0].tolist()
                for line in axes.lines
                if line.get_label() == "later"
            ]
            assert places == [[report.incident.at_s] * 2]


def test_a_record_that_was_cut_costs_only_what_it_says(
    incident: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (incident / "incident.json").write_text("{")
    for command in (["rates"], ["loss"], ["report"]):
        assert main(["bag", *command, str(incident)]) == 0
        assert "note: what happened is not known: " in capsys.readouterr().err


def test_what_was_decided_has_the_mark_too(incident: Path) -> None:
    decided = ["--decisions", "decisions.jsonl"]
    assert main(["replay", str(incident), "--rules", "rules.adirf", "--output", "again", *decided]) == 0
    assert main(["bag", "report", str(incident), "again", "--rules", "rules.adirf", *decided]) == 0
    _, lanes = Path("report.html").read_text("utf-8").split('class="over-time lanes ')
    assert 'class="incident"' in lanes.partition('class="times"')[0]
