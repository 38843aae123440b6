# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How testudo run starts, refuses and ends."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from ros.ros_processes import TESTUDO, SmallRobot
from smarttestudo.domain.errors import Extra, how_to_install

RULES = "begin SetFrequency /imu 10 end"
WITHOUT_ROS = (
    "import sys; sys.modules['rclpy'] = None; from smarttestudo.cli.main import main; sys.exit(main())"
)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(robot: SmallRobot, number: signal.Signals) -> None:
    runtime = robot.runtime(RULES)
    runtime.line_with("/imu: 10 Hz (default)")
    runtime.signal(number)
    assert runtime.exit_code() == 0
    assert not [line for line in runtime.output if "INFO" not in line]


@pytest.mark.contract
def test_a_prefix_goes_before_every_topic(robot: SmallRobot) -> None:
    decisions = robot.folder / "decisions.jsonl"
    runtime = robot.runtime(
        "begin SetFrequency imu 10 SetFrequency /odom 5 end",
        *("--topic-prefix", "/tb3_0", "--decisions", str(decisions), "--ros-args", "-r", "__ns:=/arm"),
    )
    runtime.line_with("/tb3_0/odom: 5 Hz (default)")
    topics = [json.loads(line)["topic"] for line in decisions.read_text(encoding="utf-8").splitlines()]
    assert topics == ["/tb3_0/arm/imu", "/tb3_0/odom"]


@pytest.mark.contract
def test_a_remapped_output_is_told_by_its_own_name_and_may_not_take_that_of_a_source(
    robot: SmallRobot,
) -> None:
    runtime = robot.runtime(RULES, "--ros-args", "-r", "/testudo/imu:=/far/imu")
    runtime.line_with("/imu: 10 Hz (default)")
    nodes = robot.nodes_told(lambda told: "/imu" in told["/smarttestudo"]["topics"])
    assert nodes["/smarttestudo"]["topics"]["/imu"]["output"] == "/far/imu"
    refused = robot.runtime(RULES, "--ros-args", "-r", "/testudo/imu:=/imu")
    assert refused.exit_code() == 2
    assert "/imu would be relayed to its own name" in refused.output[-1]


def test_rules_that_record_are_followed_and_that_nothing_is_recorded_is_said(robot: SmallRobot) -> None:
    runtime = robot.runtime(
        "begin SetFrequency /imu 10 If CheckValue /imu rate > 1 Then "
        'Record "moving" Before 1 s After 1 s SetFrequency /imu 20 EndIf end'
    )
    runtime.line_with("the rules have a Record, and no folder is named to record into: --incidents DIR")
    runtime.line_with("/imu: 10 Hz (default)")


@pytest.mark.parametrize("pattern", ["{topic}", "/odom"])
def test_an_output_that_is_no_name_of_its_own_is_refused_without_rules_too(
    robot: SmallRobot, pattern: str
) -> None:
    runtime = robot.testudo_run("--output-topic", pattern)
    assert runtime.exit_code() == 2
    assert runtime.output[-1].startswith("--output-topic: error: ")


@pytest.mark.contract
def test_parameters_do_what_options_do_and_options_win(robot: SmallRobot) -> None:
    for name, rate in (("one", 5), ("two", 7)):
        path = robot.folder / f"{name}.adirf"
        path.write_text(f"begin SetFrequency /{name} {rate} end", encoding="utf-8")
    files = f"['{robot.folder}/one.adirf', '{robot.folder}/two.adirf']"
    parameters = {
        "rules_file": files,
        "output_topic": "/op{topic}",
        "budget_kb_per_s": "5",
        "topic_prefix": "/x",
    }
    arguments = [part for name, value in parameters.items() for part in ("-p", f"{name}:={value}")]
    runtime = robot.testudo_run("--topic-prefix", "/tb3_0", "--ros-args", *arguments)
    runtime.line_with("Relaying 2 topics as /op{topic}")
    runtime.line_with("/tb3_0/one: 5 Hz (default)")
    runtime.line_with("/tb3_0/two: 7 Hz (default)")


@pytest.mark.parametrize(
    "parameter",
    ["when_slow:=never", "budget_kb_per_s:=-1", "topic_prefix:=x", "output_topic:=5", "rules_file:=5"],
)
def test_a_parameter_that_makes_no_sense_is_refused(robot: SmallRobot, parameter: str) -> None:
    runtime = robot.testudo_run("--ros-args", "-p", parameter)
    assert runtime.exit_code() == 2
    (line,) = runtime.output
    assert line.startswith(f"parameter {parameter.partition(':')[0]}: error: ")


@pytest.mark.contract
def test_a_rule_file_that_is_not_there_and_a_broken_one_end_it_so_that_systemd_tries_again(
    robot: SmallRobot,
) -> None:
    broken = robot.rule_file("begin SetFrequency /imu fast KeepAtLeast /imu x end")
    missing = broken.replace("rules0", "rule0")
    absent = robot.testudo_run("--rules", missing)
    assert (absent.exit_code(), absent.output) == (
        1,
        [f"{missing}: error: there is no such file; did you mean {broken}?\n"],
    )
    refused = robot.testudo_run("--rules", broken, "--ros-args", "-p", "fallback:=exit")
    assert refused.exit_code() == 1
    assert [line.partition(": error")[0] for line in refused.output if "error[" in line] == [
        f"{broken}:1:25",
        f"{broken}:1:47",
    ]
    # ROS takes the word for a boolean.
    silent = robot.testudo_run("--rules", broken, "--ros-args", "-p", "fallback:=off")
    silent.line_with("relaying nothing until there are rules")


@pytest.mark.parametrize("pattern", ["{topic}", "/odom", "{topic}_receive"])
def test_an_output_that_is_taken_is_refused(robot: SmallRobot, pattern: str) -> None:
    rules = "begin SetFrequency /imu 10 SetFrequency /imu_receive 10 end"
    runtime = robot.runtime(rules, "--output-topic", pattern)
    assert runtime.exit_code() == 2
    (line,) = runtime.output
    assert line.startswith("--output-topic: error: ")


def test_arguments_that_ros_does_not_know_are_refused(robot: SmallRobot) -> None:
    runtime = robot.runtime(RULES, "--ros-args", "--nonsense")
    assert runtime.exit_code() == 2
    (line,) = runtime.output
    assert line.startswith("--ros-args: error: ")


def test_a_folder_for_logs_that_cannot_be_made_is_named_with_what_to_do(robot: SmallRobot) -> None:
    words = [sys.executable, "-c", TESTUDO, "run", "--rules", robot.rule_file(RULES)]
    runtime = robot.command(*words, HOME="/proc/nobody", ROS_LOG_DIR="")
    assert runtime.exit_code() == 1
    (line,) = runtime.output
    assert line.startswith("ROS_LOG_DIR: error: ")
    assert line.endswith("; set ROS_LOG_DIR to a folder that can be written\n")


@pytest.mark.parametrize("domain", ["233", "999", "ada"])
def test_a_domain_that_is_none_is_named_with_those_that_are(robot: SmallRobot, domain: str) -> None:
    words = [sys.executable, "-c", TESTUDO, "run", "--rules", robot.rule_file(RULES)]
    runtime = robot.command(*words, ROS_DOMAIN_ID=domain)
    assert runtime.exit_code() == 1
    (line,) = runtime.output
    expected = f"{domain!r} is no ROS domain; set it to a number from 0 to 232"
    assert line == f"ROS_DOMAIN_ID: error: {expected}\n"


def test_without_rclpy_one_line_says_how_to_get_it(tmp_path: Path) -> None:
    rules = tmp_path / "rules.adirf"
    rules.write_text(RULES, encoding="utf-8")
    arguments = [sys.executable, "-c", WITHOUT_ROS, "run", "--rules", str(rules)]
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.splitlines() == [
        "error: this needs ROS 2 (rclpy); source your ROS setup; without a ROS 2 installation, "
        f"{how_to_install(Extra.ROS)}"
    ]
