# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A wrong command line costs one line; a command is imported when it is named."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from bags.bag_factory import small_mission, write_bag
from smarttestudo.cli.commands import command_parser
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import UsageError

COMMANDS = (
    *("demo", "check", "fmt", "run", "receive", "top", "why", "echo", "push", "replay"),
    *("incidents", "bag", "profile", "optimize", "ruler", "simulate", "completion"),
)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["check"], "error: the following arguments are required: FILE; see 'testudo check --help'\n"),
        (
            ["check", "a.adirf", "--colour", "red"],
            "error: unrecognized arguments: --colour red; see 'testudo check --help'\n",
        ),
        (
            ["bag", "rates", "a", "--nonsense"],
            "error: unrecognized arguments: --nonsense; see 'testudo bag rates --help'\n",
        ),
        (
            ["demo", "--seed", "x"],
            "--seed: error: 'x' is not a whole number of 0 or more; see 'testudo demo --help'\n",
        ),
        (
            ["demo", "--seed", "9" * 5000],
            f"--seed: error: '{'9' * 39} is not a whole number of 0 or more; see 'testudo demo --help'\n",
        ),
        (["demo", "--out"], "--out: error: expected one argument; see 'testudo demo --help'\n"),
        ([], "error: the following arguments are required: COMMAND; see 'testudo --help'\n"),
    ],
)
def test_a_wrong_command_line_is_one_line_that_names_its_help(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    assert capsys.readouterr() == ("", said)


@pytest.mark.parametrize(
    ("words", "record"),
    [
        (["/scan"], None),
        (["/scan", "d.jsonl", "--at", "3"], "d.jsonl"),
        (["/scan", "--at", "3", "d.jsonl"], "d.jsonl"),
        (["--at", "3", "/scan", "--json", "d.jsonl"], "d.jsonl"),
    ],
)
def test_what_may_be_left_out_may_stand_behind_options(words: list[str], record: str | None) -> None:
    parsed = command_parser().parse_args(["why", *words])
    assert (parsed.topic, parsed.record) == ("/scan", None if record is None else Path(record))
    with pytest.raises(UsageError, match="unrecognized arguments: more"):
        command_parser().parse_args(["why", "/scan", "d.jsonl", "--json", "more"])


@pytest.mark.parametrize(
    ("command", "option", "text"),
    [
        *(
            (("receive", "--connect", "tcp/[::1]:1"), "--foxglove", text)
            for text in ("-1", "65536", "1.0", "x")
        ),
        *((("ruler",), "--port", text) for text in ("65536", "", "٣")),
        *((("echo", "/odom"), "--count", text) for text in ("0", "1.5", "²")),
        *((("echo", "/odom"), "--seconds", text) for text in ("0", "-1", "inf", "nan", "soon")),
        *((("simulate",), "--seconds", text) for text in ("0.5", "86401", "nan", "x")),
        *((("simulate",), "--battery", text) for text in ("-1", "100.5", "nan", "full")),
        *((("simulate",), "--cover-lidar", text) for text in ("-1", "inf", "nan")),
        *((("bag", "rates", "a"), "--workers", text) for text in ("0", "-1", "two", "9" * 5000)),
        *((("run", "--rules", "a"), "--output-domain", text) for text in ("233", "-1", "1e2")),
    ],
)
def test_a_value_beyond_what_an_option_takes_is_refused_at_the_option(
    command: tuple[str, ...], option: str, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*command, f"{option}={text}"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"{option}: error: ")
    assert f"{text!r:.40}" in line
    assert "invalid" not in line
    assert len(line) < 200


@pytest.mark.parametrize(
    ("arguments", "place", "meant"),
    [
        (["chek", "a.adirf"], "COMMAND", "check"),
        (["Replay", "bag"], "COMMAND", "replay"),
        (["incident"], "COMMAND", "incidents"),
        (["bag", "rate", "a"], "ACTION", "rates"),
        (["--versio"], None, "--version"),
        (["check", "a.adirf", "--profil", "p.toml"], None, "--profile"),
        (["check", "--profil=p.toml", "a.adirf"], None, "--profile"),
        (["check", "--no-colour", "a.adirf", "--formt", "json"], None, "--format"),
        (["check", "--bg", "mission"], None, "--bag"),
        (["replay", "mission", "--rule", "a.adirf"], None, "--rules"),
        (["profile", "--secons", "5", "--ros-args", "--bags"], None, "--seconds"),
        (["bag", "loss", "a", "b", "--profil", "p.toml"], None, "--profile"),
        (["run", "--link-liste", "tcp/0.0.0.0:7447", "--ros-args", "--rule"], None, "--link-listen"),
        (["check", "a.adirf", "--format", "jsn"], "--format", "json"),
        (["run", "--when-slow", "repeet"], "--when-slow", "repeat"),
    ],
)
def test_a_misspelled_command_option_or_choice_is_refused_with_the_one_that_was_meant(
    arguments: list[str], place: str | None, meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"{place}: error: " if place else "error: ")
    assert line.endswith(f"; did you mean {meant}?")


def test_what_follows_ros_args_is_no_misspelled_option(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["profile", "--ros-args", "--secons", "5"]) == 2
    assert capsys.readouterr().err.endswith("; see 'testudo profile --help'\n")


def test_a_command_that_is_not_there_is_refused_with_those_that_are(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["nonsense"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("COMMAND: error: invalid choice: 'nonsense'")
    assert all(command in line for command in COMMANDS)
    assert line.endswith("; see 'testudo --help'")


@pytest.mark.parametrize("encoding", ["utf-8:strict", "ascii:strict"])
@pytest.mark.parametrize("options", [(), ("--csv",), ("--parquet", "tables")])
def test_a_name_that_is_no_text_costs_nothing(
    encoding: str, options: tuple[str, ...], tmp_path: Path
) -> None:
    for name in (b"\xff", b"plain"):
        write_bag(tmp_path / "fleet" / os.fsdecode(name), small_mission(1))
    done = subprocess.run(
        [sys.executable, "-m", "smarttestudo", "bag", "rates", "fleet", *options],
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": encoding},
        capture_output=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"plain" in done.stdout


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_and_a_line_in_the_help_of_all(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as left:
        main([command, "--help"])
    assert left.value.code == 0
    assert capsys.readouterr().out.startswith(f"usage: testudo {command} ")
    assert f"\n    {command}" in command_parser().format_help()


def test_only_the_command_that_is_named_is_imported() -> None:
    code = (
        "import sys; from smarttestudo.cli.main import main; main(['fmt', '--check'])\n"
        "print(*sorted(name for name in sys.modules if name.startswith('smarttestudo.cli.')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    of_commands = {f"smarttestudo.cli.{command}" for command in COMMANDS}
    assert set(done.stdout.split()) & of_commands == {"smarttestudo.cli.fmt"}
