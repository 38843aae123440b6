# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo replay --expect``: rules are tested like code, on recordings, against decisions in a file."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from bags.bag_factory import small_mission, write_bag
from smarttestudo.cli.main import main

RULES = """\
begin
  SetFrequency /odom 10
  SetFrequency /scan 1
  Rule "Far" If (CheckValue /odom pose_y > 2) Then SetFrequency /scan 5
end
"""
START = 'expected.jsonl:2: error: at 0.000 s: expected "/scan: 5 Hz (unknown: Far)"'
FAR = 'expected.jsonl:4: error: at 2.040 s: expected "/scan: 1 Hz → 5 Hz (block: Far)"'
UPDATES = "--update writes what is decided now\n"
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def replayed(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """Exit code, output and errors of a replay by rules given as text."""
    monkeypatch.chdir(tmp_path)
    write_bag(tmp_path / "bag", small_mission())

    def run(rules: str, *options: str, bags: tuple[str, ...] = ("bag",)) -> tuple[int, str, str]:
        (tmp_path / "rules.adirf").write_text(rules, encoding="utf-8")
        code = main(["replay", *bags, "--rules", "rules.adirf", *(options or ("--expect", "expected.jsonl"))])
        return (code, *capsys.readouterr())

    (tmp_path / "notes.txt").write_text("notes\n", encoding="utf-8")
    assert run(RULES, "--expect", "expected.jsonl", "--update")[0] == 0
    return run


def test_what_update_writes_are_the_decisions_and_no_recording(replayed: Run, tmp_path: Path) -> None:
    assert replayed(RULES, "--output", "out", "--decisions", "log.jsonl")[0] == 0
    assert (tmp_path / "expected.jsonl").read_bytes() == (tmp_path / "log.jsonl").read_bytes()
    code, out, err = replayed(RULES)
    assert (code, err) == (0, "")
    assert out.endswith("decisions as expected in expected.jsonl\n")
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"bag", "expected.jsonl", "log.jsonl", "notes.txt", "out", "rules.adirf"}


@pytest.mark.parametrize(
    ("rules", "said"),
    [
        (
            RULES.replace("/scan 5", "/scan 6"),
            f'{START}, decided "/scan: 6 Hz (unknown: Far)"; {UPDATES}',
        ),
        (
            RULES.replace("> 2", "> 3"),
            f'{FAR}, decided "/scan: 1 Hz → 5 Hz (block: Far)" at 3.040 s; {UPDATES}',
        ),
        (
            RULES.replace('"Far"', '"Away"'),
            f'{START}, decided "/scan: 5 Hz (unknown: Away)"; {UPDATES}',
        ),
        (RULES.replace("> 2", "> 1000"), f"{FAR}, decided nothing more; {UPDATES}"),
        (
            RULES.replace("> 2", "> 2 AND CheckValue /odom pose_x < 1000"),
            f'{START} with "values": {{"/odom pose_y": null}}, '
            f'decided "values": {{"/odom pose_x": null, "/odom pose_y": null}}; {UPDATES}',
        ),
    ],
)
def test_the_first_difference_is_one_line_with_its_place_and_exit_code_1(
    replayed: Run, rules: str, said: str, tmp_path: Path
) -> None:
    before = (tmp_path / "expected.jsonl").read_bytes()
    assert replayed(rules) == (1, "", said)
    assert (tmp_path / "expected.jsonl").read_bytes() == before
    assert replayed(rules, "--expect", "expected.jsonl", "--update")[0] == 0
    assert replayed(rules)[0] == 0


def test_what_is_decided_beyond_the_end_of_the_file_is_a_difference(replayed: Run, tmp_path: Path) -> None:
    path = tmp_path / "expected.jsonl"
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:2]))
    assert replayed(RULES) == (
        1,
        "",
        'expected.jsonl:3: error: at 0.500 s: expected nothing more, decided "/scan: 5 Hz → 1 Hz '
        f'(default)"; {UPDATES}',
    )


def test_a_comment_moves_the_lines_of_rules_and_is_no_difference(replayed: Run) -> None:
    assert replayed("// moves all lines\n" + RULES)[0] == 0


def test_a_difference_costs_neither_the_recording_nor_the_decisions(replayed: Run, tmp_path: Path) -> None:
    options = ("--expect", "expected.jsonl", "--output", "out", "--decisions", "log.jsonl")
    assert replayed(RULES.replace("/scan 5", "/scan 6"), *options)[0] == 1
    assert (tmp_path / "out" / "metadata.yaml").exists()
    rates = [json.loads(line)["to_hz"] for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert 6.0 in rates


def test_each_of_several_recordings_has_decisions_of_its_own(replayed: Run, tmp_path: Path) -> None:
    for name in ("monday", "tuesday"):
        write_bag(tmp_path / "bags" / name, small_mission())
    options = ("--expect", "expected")
    code, _, err = replayed(RULES, *options, bags=("bags",))
    assert (code, len(err.splitlines())) == (1, 2)
    assert f"expected/monday.jsonl: error: there are no expected decisions; {UPDATES}" in err
    assert not (tmp_path / "expected").exists()
    assert replayed(RULES, *options, "--update", bags=("bags",))[0] == 0
    assert replayed(RULES, *options, bags=("bags",))[0] == 0
    (tmp_path / "expected" / "tuesday.jsonl").unlink()
    assert replayed(RULES, *options, bags=("bags",))[0] == 1


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (("--update",), 2, "--update: error: it needs expected decisions; add --expect FILE\n"),
        (
            ("--expect", "notes.txt", "--update"),
            1,
            "notes.txt: error: the decision log cannot be written: the file there holds something else; "
            "name another output, or remove it\n",
        ),
        (
            ("--expect", "notes.txt"),
            1,
            "notes.txt:1: error: not a decision; give a file that --decisions wrote\n",
        ),
        (
            ("--expect", "expected.jsonl", "--report", "page.html"),
            2,
            "--report: error: it shows the new recording; add --output\n",
        ),
    ],
)
def test_what_cannot_be_compared_is_refused(
    replayed: Run, options: tuple[str, ...], code: int, said: str
) -> None:
    assert replayed(RULES, *options) == (code, "", said)


ACTING = RULES.replace("/scan 5", '/scan 5 Call /dock SetParameter /camera quality 40 Notify "far\\";$(rm) "')
PROFILE = 'allow_calls = ["/dock"]\nallow_parameters = { "/camera" = ["quality"] }\n'


def test_a_replay_does_nothing_and_writes_what_would_have_been_done(replayed: Run, tmp_path: Path) -> None:
    (tmp_path / "profile.toml").write_text(PROFILE, encoding="utf-8")
    options = ("--profile", "profile.toml", "--expect", "acting.jsonl")
    assert replayed(ACTING, *options, "--update")[0] == 0
    lines = (tmp_path / "acting.jsonl").read_text(encoding="utf-8").splitlines()
    acts = [record for record in map(json.loads, lines) if "action" in record]
    assert [(one["action"], one["target"], one["event"], one["rule"]) for one in acts] == [
        ("Call", "/dock", "begin", "Far"),
        ("Notify", 'far";$(rm) ', "begin", "Far"),
        ("SetParameter", "/camera", "begin", "Far"),
    ]
    assert acts[2]["value"] == 40
    assert acts[0]["values"].keys() == {"/odom pose_y"}
    assert replayed(ACTING, *options)[0] == 0
    code, _, err = replayed(ACTING.replace("/dock", "/rest"), *options)
    assert code == 1
    assert 'expected "Call /dock: begin (Far)", decided "Call /rest: not allowed (Far)"' in err


def test_what_came_of_actions_on_a_robot_is_not_expected_of_a_replay(replayed: Run, tmp_path: Path) -> None:
    (tmp_path / "profile.toml").write_text(PROFILE, encoding="utf-8")
    options = ("--profile", "profile.toml", "--expect", "acting.jsonl")
    replayed(ACTING, *options, "--update")
    path = tmp_path / "acting.jsonl"
    lines = path.read_text(encoding="utf-8").splitlines()
    done = next(line for line in lines if "Call" in line).replace('"begin"', '"done"')
    path.write_text("\n".join([*lines, done]) + "\n", encoding="utf-8")
    assert replayed(ACTING, *options)[0] == 0


def test_the_report_and_why_show_actions(
    replayed: Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "profile.toml").write_text(PROFILE, encoding="utf-8")
    options = ("--profile", "profile.toml", "--output", "out", "--report", "r.html", "--decisions", "d.jsonl")
    assert replayed(ACTING, *options)[0] == 0
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "/camera quality" in page
    assert "Call /dock: begin (Far)" in page
    assert "Notify &quot;far\\&quot;;$(rm) &quot;" in page
    assert main(["why", "/camera", "d.jsonl"]) == 0
    assert capsys.readouterr().out.endswith("SetParameter /camera quality 40: begin (Far)\n")
    assert main(["why", "/scan", "d.jsonl"]) == 0
    assert capsys.readouterr().out.startswith("/scan: ")
