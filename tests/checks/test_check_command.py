# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo check`` as a user meets it."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from pathlib import Path

import pytest

from bags.bag_factory import (
    ODOM,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
    small_mission,
    write_bag,
)
from smarttestudo.bags.writer import create_recording
from smarttestudo.cli import check
from smarttestudo.cli.commands import command_parser
from smarttestudo.cli.finding_text import finding_lines, print_findings, summary
from smarttestudo.domain.errors import ProfileError, UsageError
from smarttestudo.domain.finding import Finding, Severity, Span
from smarttestudo.domain.recording import Channel
from smarttestudo.language.parser import MAX_FILE_BYTES

GOOD = "begin\n  SetFrequency /odom 10\nend\n"
DOUBTFUL = "begin\n  SetFrequency /odom 10\n  SetFrequency /odom 4\nend\n"
WRONG = "begin\n  SetFrequency /odom\n  SetFrequency /scan Desirable\nend\n"


def run_check(*arguments: object) -> int:
    code: int = check.run(command_parser().parse_args(["check", *map(str, arguments)]))
    return code


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, text in (("good", GOOD), ("doubtful", DOUBTFUL), ("wrong", WRONG)):
        (tmp_path / f"{name}.adirf").write_text(text)
    return tmp_path


def test_a_finding_shows_its_place_the_text_and_a_hint(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_check("doubtful.adirf") == 0
    assert capsys.readouterr().out == (
        "doubtful.adirf:2:3: warning[two-defaults]: this default of /odom is overridden by that of line 3\n"
        "    SetFrequency /odom 10\n"
        "    ^^^^^^^^^^^^^^^^^^^^^\n"
        "    hint: the last default counts; remove this one\n"
        "1 warning in 1 file\n"
    )


def test_a_clean_file_exits_with_0_and_says_so(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_check("good.adirf") == 0
    assert capsys.readouterr().out == "no findings in 1 file\n"


def test_errors_exit_with_1_and_are_all_reported(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_check("wrong.adirf") == 1
    out = capsys.readouterr().out
    assert "wrong.adirf:3:22: error[tier-without-rate]: Desirable has no rate without a profile" in out
    assert out.endswith("2 errors in 1 file\n")


def test_a_folder_stands_for_its_rule_files_and_each_file_counts_once(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_check(folder, "good.adirf") == 1
    assert capsys.readouterr().out.endswith("in 3 files\n")


def test_files_that_cannot_be_read_are_named_and_the_others_are_checked(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "wide.adirf").write_bytes(GOOD.encode("utf-16"))
    assert run_check("missing.adirf", "wide.adirf", "doubtful.adirf") == 1
    captured = capsys.readouterr()
    assert "two-defaults" in captured.out
    assert captured.err.splitlines() == [
        "missing.adirf: error: there is no such file; check the path",
        "wide.adirf: error: the rule file is in UTF-16; save it as UTF-8",
    ]


def test_json_is_a_list_of_findings(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_check("doubtful.adirf", "--format", "json") == 0
    (finding,) = json.loads(capsys.readouterr().out)
    assert finding == {
        "code": "two-defaults",
        "severity": "warning",
        "message": "this default of /odom is overridden by that of line 3",
        "path": "doubtful.adirf",
        "line": 2,
        "column": 3,
        "end_line": 2,
        "end_column": 24,
        "hint": "the last default counts; remove this one",
        "fix": {
            "title": "remove the overridden default",
            "replacement": "",
            "line": 2,
            "column": 3,
            "end_line": 2,
            "end_column": 24,
        },
    }


def test_json_without_findings_is_an_empty_list(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_check("good.adirf", "--format", "json") == 0
    assert json.loads(capsys.readouterr().out) == []


def test_a_profile_adds_what_it_knows(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "profile.toml").write_text('[topics."/odom"]\n[topics."/scan"]\n')
    assert run_check("good.adirf", "--profile", "profile.toml") == 0
    assert "profile.toml:1:1: info[unnamed-in-profile]: no rule names /scan" in capsys.readouterr().out


def test_a_broken_profile_is_an_error(folder: Path) -> None:
    (folder / "profile.toml").write_text("budget = 3\n")
    with pytest.raises(ProfileError, match="unknown key"):
        run_check("good.adirf", "--profile", "profile.toml")


def test_a_recording_tells_which_topics_it_lacks_and_what_types_it_has(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with create_recording(folder / "bag") as recording:
        recording.write(Channel(topic="/odom", type_name="nav_msgs/msg/Odometry"), 1, b"\0\1\0\0")
    (folder / "robot.adirf").write_text(
        "begin\n  SetFrequency /odm 10\n  If CheckValue /odom pose_X > 1 Then SetFrequency /odm 4\nend\n"
    )
    assert run_check("robot.adirf", "--bag", "bag", "--format", "json") == 0
    found = {one["code"]: one["hint"] for one in json.loads(capsys.readouterr().out)}
    assert found == {"absent-from-bag": "did you mean '/odom'?", "unknown-property": "did you mean 'pose_x'?"}


def test_a_recording_that_is_not_whole_is_told_beside_the_findings(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with create_recording(folder / "bag") as recording:
        recording.write(Channel(topic="/odom", type_name="nav_msgs/msg/Odometry"), 1, b"\0\1\0\0")
    (folder / "bag" / "metadata.yaml").unlink()
    assert run_check("good.adirf", "--bag", "bag", "--format", "json") == 0
    said = capsys.readouterr()
    assert json.loads(said.out) == []
    assert said.err == "note: bag: metadata.yaml is missing; the files in the folder were read instead\n"


def test_an_unknown_format_is_wrong_usage(folder: Path) -> None:
    with pytest.raises(UsageError, match="invalid choice: 'xml'"):
        run_check("good.adirf", "--format", "xml")


def test_checking_without_a_bag_needs_no_package_beyond_the_standard_library() -> None:
    program = (
        "import sys; import smarttestudo.cli.check\n"
        "print(sorted({'rosbags', 'mcap', 'numpy', 'rich'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def finding_at(
    line: int, column: int, end_line: int, end_column: int, *, message: str = "m", hint: str = ""
) -> Finding:
    span = Span(line=line, column=column, end_line=end_line, end_column=end_column)
    return Finding(code="c", severity=Severity.INFO, message=message, path="f.adirf", span=span, hint=hint)


def test_the_underline_of_several_lines_ends_with_the_first() -> None:
    shown = finding_lines(finding_at(1, 3, 2, 5), ["  If (a AND  ", "   b)"])
    assert shown[1:] == ["    If (a AND", "    ^^^^^^^^^"]


def test_the_underline_stays_under_the_text_after_tabs_and_wide_letters() -> None:
    shown = finding_lines(finding_at(1, 10, 1, 13), ["\tRule 宮 \tabc"])
    assert shown[1:] == ["    Rule 宮  abc", "    " + " " * 9 + "^^^"]


def test_a_very_long_line_is_cut_around_the_finding() -> None:
    line = "x" * 500 + "here" + "y" * 500
    shown = finding_lines(finding_at(1, 501, 1, 505), [line])
    assert shown[1] == "    " + "x" * 30 + "here" + "y" * 66 + " …"
    assert shown[2] == "    " + " " * 30 + "^^^^"


def test_a_finding_at_the_end_of_the_file_has_a_caret() -> None:
    assert finding_lines(finding_at(1, 4, 1, 4), ["end"])[1:] == ["    end", "       ^"]
    assert len(finding_lines(finding_at(9, 1, 9, 1), ["end"])) == 1


def test_the_underline_stays_under_what_is_shown_of_a_control_character() -> None:
    shown = finding_lines(finding_at(1, 2, 1, 4, message="\x1b[2Jm", hint="\x07"), ["a\x1b[31mb"])
    assert shown[0].endswith(r"\u001b[2Jm")
    assert shown[1:] == [r"    a\u001b[31mb", "     ^^^^^^^", r"    hint: \u0007"]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(("no_color", "coloured"), [("", True), ("1", False)])
def test_colour_is_for_terminals_whose_user_wants_it(
    monkeypatch: pytest.MonkeyPatch, no_color: str, *, coloured: bool
) -> None:
    monkeypatch.setenv("NO_COLOR", no_color)
    monkeypatch.setenv("TERM", "xterm")
    terminal, pipe = Terminal(), io.StringIO()
    for stream in (terminal, pipe):
        print_findings([finding_at(1, 1, 1, 4)], {"f.adirf": "end"}, stream)
    assert ("\x1b[36m" in terminal.getvalue()) == coloured
    assert "\x1b" not in pipe.getvalue()


def test_the_summary_counts_by_severity() -> None:
    info = finding_at(1, 1, 1, 2)
    assert summary([info, info], files=2) == "2 infos in 2 files"


@pytest.mark.parametrize(
    ("check", "finding"),
    [
        ("/odom pose.pose.positon.x > 3", "its messages have no pose.pose.positon"),
        ("/odom pose.pose > 3", "it has parts, such as pose.pose.position"),
        ("/odom pose.covariance > 3", "it is a list, of which pose.covariance[0] is the first element"),
        ("/map_name data = 3", "it is a text, and no number"),
        ("/gripper holts = 1", "its messages have no holts"),
        ("/silent pose_x > 1", "it holds no message of it"),
        ("/scan ranges[7] > 1", "it is unknown in all of its 20 messages"),
        ("/odom pose.pose.position.x > 3", None),
        ("/gripper holds = 1", None),
        ("/silent rate > 1", None),
    ],
)
def test_a_check_that_never_had_a_value_in_the_recording_says_why(
    check: str, finding: str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mission = small_mission()
    content = BagContent((*mission.topics, BagTopic("/silent", ODOM.type_name)), mission.messages)
    bag, rules = write_bag(tmp_path / "bag", content), tmp_path / "rules.adirf"
    rules.write_text(f"begin SetFrequency /odom 9 If CheckValue {check} Then SetFrequency /odom 1 EndIf end")
    assert run_check(rules, "--bag", bag, "--format", "json") == 0
    found = {one["code"]: one for one in json.loads(capsys.readouterr().out)}
    if finding is None:
        assert "never-a-number" not in found
    else:
        topic, name, *_ = check.split()
        assert (
            found["never-a-number"]["message"] == f"the recording has no value of {topic} {name}: {finding}"
        )


def test_a_field_one_letter_off_is_offered_and_topics_without_a_rule_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag, rules = write_bag(tmp_path / "bag", small_mission()), tmp_path / "rules.adirf"
    rules.write_text(
        "begin SetFrequency /odom 9 If CheckValue /odom pose.pose.positon.x > 3"
        " Then SetFrequency /odm 1 EndIf end"
    )
    assert run_check(rules, "--bag", bag) == 0
    out = capsys.readouterr().out
    assert "hint: did you mean 'pose.pose.position.x'?" in out
    assert "the recording has no /odm\n" in out
    assert (
        "info[unnamed-in-bag]: no rule names /gripper, /image, /map_name and /scan, which the recording"
        in out
    )


@pytest.mark.parametrize(("greatest", "is_share"), [(0.9, True), (1.0, True), (87.0, False)])
def test_a_battery_that_is_recorded_in_percent_may_be_compared_in_percent(
    greatest: float, is_share: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    battery = "sensor_msgs/msg/BatteryState"
    messages = tuple(
        BagMessage(
            "/battery", START_NS + number, cdr(battery, message_of(battery, percentage=share * greatest))
        )
        for number, share in enumerate((1.0, 0.5))
    )
    bag = write_bag(tmp_path / "bag", BagContent((BagTopic("/battery", battery),), messages))
    rules = tmp_path / "rules.adirf"
    rules.write_text(
        "begin SetFrequency /battery 9 If CheckValue /battery percentage < 20"
        " Then SetFrequency /battery 1 end"
    )
    assert run_check(rules, "--bag", bag) == 0
    assert ("share-as-percent" in capsys.readouterr().out) is is_share


def test_a_topic_of_a_recording_that_cannot_be_decoded_is_told_with_the_reason(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with create_recording(folder / "bag") as recording:
        recording.write(Channel(topic="/odom", type_name="nav_msgs/msg/Odometry"), 1, b"\0\1\0\0")
        recording.write(Channel(topic="/gps", type_name="gps", serialization_format="json"), 2, b"{}")
    assert run_check("good.adirf", "--bag", "bag", "--format", "json") == 0
    said = capsys.readouterr().err
    assert said == "note: /gps: recorded as json, not as cdr; checks of its fields stay unknown\n"


def test_standard_input_is_a_file_of_the_set(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def given(text: bytes) -> None:
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text)))

    given(DOUBTFUL.encode())
    assert run_check("-", "good.adirf", "-") == 0
    out = capsys.readouterr().out
    assert out.startswith("<stdin>:2:3: warning[two-defaults]: ")
    assert out.endswith(" in 2 files\n")
    given("begin // \xfc\nend".encode("latin-1"))
    assert run_check("-", "good.adirf") == 1
    assert capsys.readouterr() == (
        "no findings in 1 file\n",
        "<stdin>:1:10: error: the byte 0xFC is not UTF-8; save it as UTF-8\n",
    )
    given(b"x" * (MAX_FILE_BYTES + 1))
    assert run_check("-") == 1
    assert "<stdin>: error: the rule file is larger than 4 MB; " in capsys.readouterr().err


def test_standard_input_that_is_closed_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    assert run_check("-") == 1
    assert capsys.readouterr().err == (
        "<stdin>: error: the rule file cannot be read: it is closed; give a rule file\n"
    )
