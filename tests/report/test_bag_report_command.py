# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag report`` and ``--figures``, as a user runs them."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from bags.bag_factory import START_NS, BagContent, small_mission, write_bag
from report.bag_desk import Ran
from report.golden_files import assert_reads_as, page_lines
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import Extra, how_to_install
from smarttestudo.domain.units import NS_PER_S

RULES = """begin
    SetFrequency /odom 5
    SetFrequency /scan Full
    Rule "Far"
    If (CheckValue /odom pose_y > 2)
    Then
        SetFrequency /odom 10
    EndIf
end
"""
GOLDEN = Path(__file__).parent / "golden"
ALL_FIGURES = {
    f"{name}.{form}"
    for name in ("rates", "bandwidth", "total", "intervals", "accuracy", "path")
    for form in ("png", "svg")
}


class Desk:
    """A folder with a recording, rules, what a replay made of both, and its decisions."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self.folder = folder
        self._capsys = capsys

    def run(self, *arguments: str) -> Ran:
        self._capsys.readouterr()
        code = main(list(arguments))
        captured = self._capsys.readouterr()
        return Ran(code, captured.out, captured.err)

    def report(self, *arguments: str) -> Ran:
        return self.run("bag", "report", *arguments)

    def refuses(self, *arguments: str) -> str:
        ran = self.report(*arguments)
        assert (ran.code, ran.out) == (1, "")
        assert not (self.folder / "report.html").exists()
        return ran.err.rstrip("\n")

    @property
    def html(self) -> str:
        return (self.folder / "report.html").read_text("utf-8")

    def names_in(self, folder: str) -> set[str]:
        return {path.name for path in (self.folder / folder).iterdir()}


@pytest.fixture(scope="module")
def replayed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("replayed")
    rules = folder / "rules.adirf"
    rules.write_text(RULES)
    sent = write_bag(folder / "sent", small_mission())
    written = ("--output", str(folder / "received"), "--decisions", str(folder / "log.jsonl"))
    assert main(["replay", str(sent), "--rules", str(rules), *written]) == 0
    return folder


@pytest.fixture
def desk(
    replayed: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> Desk:
    shutil.copytree(replayed, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return Desk(tmp_path, capsys)


def shifted(content: BagContent, seconds: int) -> BagContent:
    later = (replace(one, stamp_ns=one.stamp_ns + seconds * NS_PER_S) for one in content.messages)
    return replace(content, messages=tuple(later))


def test_decisions_that_were_cut_off_are_told_of(desk: Desk) -> None:
    whole = (desk.folder / "log.jsonl").read_text("utf-8")
    (desk.folder / "cut.jsonl").write_text(whole + whole[:20], "utf-8")
    for command in (("report", "sent"), ("loss", "sent", "received")):
        ran = desk.run("bag", *command, "--rules", "rules.adirf", "--decisions", "cut.jsonl")
        assert ran.code == 0
        assert "note: cut.jsonl:5: cut off, as where the run was killed" in ran.err


def test_the_reports_of_a_replay_and_of_one_recording_read_as_in_the_golden_files(desk: Desk) -> None:
    ran = desk.report("sent", "received", "--rules", "rules.adirf", "--decisions", "log.jsonl")
    assert (ran.code, ran.err) == (0, "")
    assert ran.out == "report.html: −90 % bandwidth, /odom error 7.2 cm, at fixed rates 5.4 cm\n"
    assert_reads_as(GOLDEN / "page-replay.html", page_lines(desk.html))
    ran = desk.report("sent", "--topics", "/odom", "-o", "one.html")
    assert (ran.code, ran.err) == (0, "")
    assert ran.out == "one.html: 17.9 KB/s\n"
    assert_reads_as(GOLDEN / "page-recording.html", page_lines(Path("one.html").read_text("utf-8")))


def test_recordings_of_different_times_are_shown_from_their_starts_and_that_is_said(desk: Desk) -> None:
    write_bag(desk.folder / "later", shifted(small_mission(), 3600))
    ran = desk.report("sent", "later")
    assert ran.code == 0
    assert "note: the recordings share no time; each is shown from its own start\n" in ran.err
    assert "note: what was lost is not known: it has no time in common with sent\n" in ran.err
    assert "share no time" in desk.html


def test_of_decisions_before_the_recording_the_last_is_where_a_topic_starts(desk: Desk) -> None:
    mission = small_mission()
    at_ns = [START_NS + round(t_s * NS_PER_S) for t_s in (1.5, 3.5)]
    part = tuple(one for one in mission.messages if at_ns[0] <= one.stamp_ns <= at_ns[1])
    write_bag(desk.folder / "part", replace(mission, messages=part))
    log = [json.loads(line) for line in (desk.folder / "log.jsonl").read_text().splitlines()]
    assert [(one["topic"], one["to_hz"]) for one in log] == [
        ("/odom", 10.0),
        ("/scan", None),
        ("/odom", 5.0),
        ("/odom", 10.0),
    ]
    desk.report("part", "--decisions", "log.jsonl", "--rules", "rules.adirf")
    assert desk.html.count('data-time="') == 3
    early = [one for one in log if one["stamp_ns"] < at_ns[0]]
    # Another run of yesterday that relayed another topic, too.
    other = [{**one, "stamp_ns": 5, "topic": f"/old{one['topic']}"} for one in early]
    later = {**log[-1], "stamp_ns": at_ns[1] + NS_PER_S}
    (desk.folder / "runs.jsonl").write_text("\n".join(map(json.dumps, [*other, *log, later])) + "\n")
    desk.report("part", "--decisions", "runs.jsonl", "--rules", "rules.adirf", "-o", "again.html")
    assert Path("again.html").read_text("utf-8").count('data-time="') == 3
    assert (desk.folder / "again.html").read_text("utf-8").count("/old") == 0


def test_decisions_of_another_time_are_left_out_and_that_is_said(desk: Desk) -> None:
    log = (desk.folder / "log.jsonl").read_text()
    (desk.folder / "old.jsonl").write_text(log.replace(str(START_NS)[:4], "1600"))
    ran = desk.report("sent", "received", "--decisions", "old.jsonl")
    assert "note: no decision falls into the time of the recording; they are left out\n" in ran.err
    assert "What the rules decided" not in desk.html


def test_what_cannot_be_reported_is_refused_in_one_line(desk: Desk) -> None:
    (desk.folder / "bad.adirf").write_text("begin SetFrequency /odom end")
    assert "nowhere: error: " in desk.refuses("nowhere")
    assert desk.refuses("sent", "--topics", "/odm") == "sent: error: no topic /odm; did you mean /odom?"
    assert "bad.adirf:1:" in desk.refuses("sent", "--rules", "bad.adirf")
    assert desk.refuses("sent", "--decisions", "rules.adirf") == (
        "rules.adirf:1: error: not a decision; give a file that --decisions wrote"
    )
    assert desk.refuses("sent", "--nav2-map", "rules.adirf").startswith("rules.adirf: error: not a nav2 map")
    assert "there/report.html: error: the report cannot be written" in desk.refuses(
        "sent", "-o", "there/report.html"
    )


@pytest.mark.full
def test_the_actions_draw_what_they_tell(desk: Desk) -> None:
    drawn = ("--topics", "/odom", "--figures")
    assert desk.run("bag", "rates", "sent", *drawn, "r").code == 0
    assert desk.run("bag", "bandwidth", "sent", "--budget", "20", *drawn, "b").code == 0
    ran = desk.run("bag", "compare", "sent", "received", "--csv", *drawn, "c")
    assert desk.report("sent", "received", "--rules", "rules.adirf", *drawn, "figures").code == 0
    assert desk.names_in("r") == {name for name in ALL_FIGURES if name.startswith(("rates", "intervals"))}
    assert desk.names_in("b") == {name for name in ALL_FIGURES if name.startswith(("band", "total"))}
    assert desk.names_in("c") == {name for name in ALL_FIGURES if not name.startswith(("accuracy", "path"))}
    assert desk.names_in("figures") == ALL_FIGURES
    assert "wrote c/rates.svg\n" in ran.err
    assert "wrote" not in ran.out


def test_without_matplotlib_one_line_says_how_to_get_it(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("smarttestudo.report.figures")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, "smarttestudo.report.bag_report", raising=False)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    ran = desk.run("bag", "rates", "sent", "--figures", "figures")
    assert ran.code == 1
    assert ran.err == (f"error: this command needs the package matplotlib; {how_to_install(Extra.STUDIO)}\n")


def test_a_recording_too_short_for_a_rate_has_a_report_that_says_so(desk: Desk) -> None:
    write_bag(desk.folder / "short", small_mission(0.04))
    assert desk.report("short").code == 0
    assert "the recording holds no whole second" in desk.html
