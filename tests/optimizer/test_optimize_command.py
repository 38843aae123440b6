# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo optimize``, from files to files."""

from __future__ import annotations

import json
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
from optimizer import golden
from optimizer.rule_files import write_inspection, write_profile
from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.cli.main import main
from smarttestudo.domain.finding import Severity
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import SetFrequency
from smarttestudo.optimizer.model import Model
from smarttestudo.rules.optimize import UsableText, optimize_text


def test_the_golden_file_gets_the_thesis_s_rates_and_keeps_its_text(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = write_inspection(tmp_path), write_profile(tmp_path, golden.AMPLE_KB_PER_S)
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 0
    first, *lines = capsys.readouterr().out.splitlines()
    assert first.startswith(
        "// Rates by testudo optimize: model quper, budget 275 000 KB/s, profile profile.toml"
    )
    assert (
        "\n".join(lines)
        == """\
begin
    // Topics of the profile without a default
    SetFrequency /cmd_vel 5 Hz
    SetFrequency /odom 10 Hz
    SetFrequency /camera/camera_info 10 Hz
    SetFrequency /camera/image_raw/compressed 5 Hz
    SetFrequency /camera/image_raw 2 Hz
    SetFrequency /imu 50 Hz
    SetFrequency /joint_state 2 Hz
    SetFrequency /scan 2 Hz
    SetFrequency /tf 2 Hz

    // The shelf that broke last year.
    Rule "Inspection"
    If (CheckValue /odom pose_x > 11 AND CheckValue /odom pose_x < 15)
    Then
        SetFrequency /imu 200 // it shakes
        SetFrequency /camera/image_raw 35
end"""
    )


def test_a_disabled_block_keeps_its_levels_and_takes_no_bandwidth(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = write_inspection(tmp_path), write_profile(tmp_path, golden.AMPLE_KB_PER_S)
    text = rules.read_text()
    rules.write_text(text.replace('Rule "Inspection"', 'Disabled Rule "Inspection"'))
    assert main(["optimize", str(rules), "--profile", str(profile), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["defaults"], answer["blocks"]) == (golden.DEFAULTS_HZ, [])
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 0
    block = text[text.index("If (") :]
    assert capsys.readouterr().out.endswith(f'Disabled Rule "Inspection"\n    {block}')


def test_json_has_the_golden_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rules, profile = write_inspection(tmp_path), write_profile(tmp_path, golden.AMPLE_KB_PER_S)
    assert main(["optimize", str(rules), "--profile", str(profile), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["defaults"] == golden.DEFAULTS_HZ
    (block,) = answer["blocks"]
    assert (block["rule"], block["line"], block["feasible"]) == ("Inspection", 3, True)
    assert block["rates"] == {"/imu": 200, "/camera/image_raw": 35}
    assert block["used_kb_per_s"] == 219_881.72
    assert block["topics"]["/imu"]["held_by"] == "the upper end of its level"


def test_what_does_not_fit_is_explained_with_what_would(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = write_inspection(tmp_path), write_profile(tmp_path, golden.SCARCE_KB_PER_S)
    output = tmp_path / "out.adirf"
    assert main(["optimize", str(rules), "--profile", str(profile), "-o", str(output)]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    error, *hints = printed.err.splitlines()
    assert error == (
        f'{rules}:3:5: error[infeasible]: "Inspection" needs at least 157 665.72 KB/s, 142 665.72 more than '
        "the budget of 15 000: /camera/image_raw Excessive takes 155 500, /imu Competitive takes 48 and "
        "the other topics' defaults 2 117.72"
    )
    assert hints == [
        "    hint: /camera/image_raw Marginal fits with 14 605.72 KB/s",
        "    hint: a budget of 157 665.72 KB/s would do",
    ]
    assert not output.exists()


def test_the_budget_that_is_proposed_fits(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rules, profile = tmp_path / "rules.adirf", tmp_path / "profile.toml"
    rules.write_text("begin SetFrequency /odom Marginal end")
    topic = '[topics."/odom"]\nmessage_kb = 0.5\ntiers_hz = [1.001, 2, 3, 4, 5, 6]\n'
    profile.write_text("budget_kb_per_s = 0.5\n" + topic)
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 1
    said = capsys.readouterr().err
    assert "need at least 0.51 KB/s, 0.01 more than the budget of 0.5" in said
    assert "hint: a budget of 0.51 KB/s would do" in said
    profile.write_text("budget_kb_per_s = 0.51\n" + topic)
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 0


BESIDE = """
begin
    SetFrequency /scan Marginal
    {default}
    If CheckValue /scan distance < 1 Then {block} EndIf
end"""
PROFILE_BESIDE = """budget_kb_per_s = {budget}
[topics."/scan"]
message_kb = 1
source_hz = 25
tiers_hz = [1, 10, 20, 30, 40, 50]
[topics."/odom"]
message_kb = 1
source_hz = 25
tiers_hz = [1, 10, 20, 30, 40, 50]
tiers_m = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]
tiers_m_need_hz = [1, 2, 4, 8, 16, 24]
"""


@pytest.mark.parametrize(
    ("default", "block", "enough"),
    [
        ("SetFrequency /odom Off", "SetFrequency /odom 5", 15),
        ("SetFrequency /odom Marginal", "KeepWithin /odom position Competitive SetFrequency /scan 12", 20),
    ],
)
def test_the_budget_that_is_proposed_fits_though_the_defaults_take_more_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], default: str, block: str, enough: float
) -> None:
    rules, profile = tmp_path / "rules.adirf", tmp_path / "profile.toml"
    rules.write_text(BESIDE.format(default=default, block=block))
    profile.write_text(PROFILE_BESIDE.format(budget=9))
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 1
    assert f"hint: a budget of {enough} KB/s would do" in capsys.readouterr().err
    profile.write_text(PROFILE_BESIDE.format(budget=enough))
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 0
    profile.write_text(PROFILE_BESIDE.format(budget=enough - 0.01))
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 1


def test_what_does_not_fit_has_no_rates_in_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rules, profile = write_inspection(tmp_path), write_profile(tmp_path, golden.SCARCE_KB_PER_S)
    assert main(["optimize", str(rules), "--profile", str(profile), "--json"]) == 1
    (block,) = json.loads(capsys.readouterr().out)["blocks"]
    assert block["rates"] is None
    assert block["feasible"] is False
    assert block["needs_kb_per_s"] == 157_665.72
    assert block["changes"] == [{"topics": {"/camera/image_raw": "Marginal"}, "needs_kb_per_s": 14_605.72}]


def test_the_change_that_is_proposed_fits(tmp_path: Path) -> None:
    rules = write_inspection(tmp_path, camera="Marginal")
    profile = write_profile(tmp_path, golden.SCARCE_KB_PER_S)
    assert main(["optimize", str(rules), "--profile", str(profile), "-o", str(tmp_path / "out.adirf")]) == 0


LAYOUTS = {
    "one line": "begin SetFrequency /odom Marginal If CheckValue /odom vel > 1 Then SetFrequency /tf Off end",
    "CRLF": "begin\r\n  SetFrequency /odom 3 Hz // mine\r\n  SetFrequency /imu Off\r\nend\r\n",
    "two collections": """\
// a comment
begin
KeepAtLeast /odom 3
If CheckValue /odom vel > 1 Then SetFrequency /tf Desirable
Else SetFrequency /tf Marginal EndIf
  SetFrequency /scan Desirable
end
begin end""",
    "tabs": "begin\n\tIf CheckValue /odom vel > 1 Then\n\t\tSetFrequency /tf Desirable\nend",
}


@pytest.mark.parametrize("text", LAYOUTS.values(), ids=LAYOUTS)
def test_what_is_written_passes_the_checker_in_every_layout(text: str, tmp_path: Path) -> None:
    rules, output = tmp_path / "rules.adirf", tmp_path / "out.adirf"
    rules.write_bytes(text.encode())
    profile = write_profile(tmp_path, golden.AMPLE_KB_PER_S)
    assert main(["optimize", str(rules), "--profile", str(profile), "-o", str(output)]) == 0
    written = output.read_bytes().decode()
    assert written.count("\r\n") == (written.count("\n") if "\r\n" in text else 0)
    result = parse(written, "out.adirf")
    findings = check_rules([result], CheckContext())
    assert [finding for finding in findings if finding.severity is Severity.ERROR] == []
    defaults = {one.topic.text for one in result.file.statements if isinstance(one, SetFrequency)}
    assert defaults == set(golden.DEFAULTS_HZ)
    assert all(word in written.split() for word in text.split() if word not in {"Marginal", "Desirable"})


@pytest.mark.parametrize("text", [*LAYOUTS.values(), f"// Rates by testudo optimize: x\n{LAYOUTS['tabs']}"])
def test_a_byte_order_mark_stays_in_front_of_the_same_text(text: str) -> None:
    def written(text: str) -> str | None:
        usable = UsableText(text=text, file=parse(text, "rules.adirf").file)
        done = optimize_text(
            usable, golden.profile(), model=Model.QUPER, only_named=False, profile_sha256="0"
        )
        return done.rewritten

    assert written(f"\ufeff{text}") == f"\ufeff{written(text)}"


def test_optimizing_what_was_written_changes_nothing_but_is_not_piled_up(tmp_path: Path) -> None:
    rules, output, again = write_inspection(tmp_path), tmp_path / "out.adirf", tmp_path / "again.adirf"
    profile = write_profile(tmp_path, golden.AMPLE_KB_PER_S)
    main(["optimize", str(rules), "--profile", str(profile), "-o", str(output)])
    main(["optimize", str(output), "--profile", str(profile), "-o", str(again)])
    assert again.read_text() == output.read_text()


def test_only_named_appends_nothing_and_asks_what_full_costs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules = tmp_path / "rules.adirf"
    rules.write_text("begin SetFrequency /odom Marginal end")
    profile = write_profile(tmp_path, golden.AMPLE_KB_PER_S)
    assert main(["optimize", str(rules), "--profile", str(profile), "--only-named"]) == 0
    assert capsys.readouterr().out.splitlines()[1] == "begin SetFrequency /odom 15 end"
    inspection = write_inspection(tmp_path)
    assert main(["optimize", str(inspection), "--profile", str(profile), "--only-named"]) == 1
    assert 'error: [topics."/imu"] has no source_hz; add source_hz' in capsys.readouterr().err


def test_explain_says_what_holds_each_rate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rules = write_inspection(tmp_path, camera="Marginal")
    profile = write_profile(tmp_path, golden.SCARCE_KB_PER_S)
    output = tmp_path / "out.adirf"
    assert main(["optimize", str(rules), "--profile", str(profile), "--explain", "-o", str(output)]) == 0
    printed = capsys.readouterr().out
    assert "14 994.92 of 15 000 KB/s" in printed
    held = {line.split()[0]: line for line in printed.splitlines() if line.startswith("/")}
    assert held["/camera/image_raw"].endswith("the budget")
    assert held["/imu"].endswith("the upper end of its level")


@pytest.mark.parametrize(
    ("rules", "profile", "error"),
    [
        ("begin SetFrequency /lidar Marginal end", "", "/lidar is in the rules but not in the profile"),
        ("begin SetFrequency /odom Marginl end", "", "error[expected-rate]"),
        ("begin end", "[topics.'/x']\nmessage_kb = 1\ntiers_hz = [1, 2, 3, 4, 5]", "list of six rates"),
        ("begin end", "[topics.'/x']\nmessage_kb = nan", "must be a finite number"),
        ("begin end", "[topics.'/x']\nmessage_kb = 1", '[topics."/x"] has no tiers_hz; add tiers_hz'),
        (
            "begin SetFrequency /x Marginal end",
            "[topics.'/x']\nmessage_kb = 1",
            "add tiers_hz, its six levels in Hz, as in [1, 2, 5, 10, 15, 20], or write a rate, as 4, Full or "
            "Off, in place of its level in the rules",
        ),
        ("begin end", "[topics.'/x']\nmessag_kb = 1", "did you mean message_kb?"),
    ],
    ids=["unknown topic", "error in the rules", "five tiers", "NaN", "no tiers", "level", "unknown key"],
)
def test_bad_input_is_one_line_and_exit_code_1(
    rules: str, profile: str, error: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "rules.adirf"
    path.write_text(rules)
    written = write_profile(tmp_path, golden.AMPLE_KB_PER_S, extra=profile)
    assert main(["optimize", str(path), "--profile", str(written)]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert error in printed.err.splitlines()[0]


def test_a_negative_budget_and_an_unreadable_profile_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules = write_inspection(tmp_path)
    profile = write_profile(tmp_path, -1.0)
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 1
    assert (
        capsys.readouterr().err == f"{profile}:1:1: error: budget_kb_per_s must not be negative, it is -1\n"
    )
    assert main(["optimize", str(rules), "--profile", str(tmp_path)]) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_where_the_defaults_do_not_fit_only_they_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = tmp_path / "rules.adirf", write_profile(tmp_path, 3000.0)
    rules.write_text(
        "begin SetFrequency /camera/image_raw Marginal "
        "If CheckValue /odom vel > 1 Then SetFrequency /imu Desirable EndIf end"
    )
    assert main(["optimize", str(rules), "--profile", str(profile)]) == 1
    error, *hints = capsys.readouterr().err.splitlines()
    assert "error[infeasible]: the defaults need at least 12 440 KB/s" in error
    assert hints[0] == "    hint: /camera/image_raw Unacceptable fits with 0 KB/s"
    assert main(["optimize", str(rules), "--profile", str(profile), "--json"]) == 1
    answer = json.loads(capsys.readouterr().out)
    assert answer["defaults"] is None
    assert [block["rates"] for block in answer["blocks"]] == [None]


def test_a_topic_that_a_profile_has_no_levels_of_is_full(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Static frames, of which a recording has one message, and a topic without any."""
    frames, silent = BagTopic("/tf_static", "tf2_msgs/msg/TFMessage"), BagTopic("/silent", ODOM.type_name)
    mission = small_mission()
    once = BagMessage(frames.name, START_NS + 1, cdr(frames.type_name, message_of(frames.type_name)))
    content = BagContent((*mission.topics, frames, silent), (*mission.messages, once))
    bag, profile = write_bag(tmp_path / "bag", content), tmp_path / "profile.toml"
    assert main(["profile", "--bag", str(bag), "-o", str(profile)]) == 0
    rules = tmp_path / "rules.adirf"
    for text in ("SetFrequency /odom Desirable", "SetFrequency /odom Desirable SetFrequency /tf_static Full"):
        rules.write_text(f"begin {text} end")
        assert main(["optimize", str(rules), "--profile", str(profile), "--budget", "200"]) == 0
        printed = capsys.readouterr().out
        assert "budget 200 KB/s" in printed
        assert "SetFrequency /tf_static Full" in printed
        assert "SetFrequency /map_name Full" in printed
        assert "/silent" not in printed


def test_a_budget_on_the_command_line_replaces_that_of_the_profile(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = write_inspection(tmp_path), write_profile(tmp_path, golden.AMPLE_KB_PER_S)
    assert main(["optimize", str(rules), "--profile", str(profile), "--budget", "1"]) == 1
    assert "more than the budget of 1:" in capsys.readouterr().err
