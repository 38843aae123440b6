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

COMMANDS = (
    *("demo", "check", "fmt", "run", "receive", "top", "echo", "replay"),
    *("incidents", "bag", "profile", "optimize", "ruler", "simulate"),
)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["check"], "error: the following arguments are required: FILE; see 'testudo check --help'\n"),
        (
            ["check", "a.adirf", "--profil", "p.toml"],
            "error: unrecognized arguments: --profil p.toml; see 'testudo check --help'\n",
        ),
        (
            ["bag", "rates", "a", "--nonsense"],
            "error: unrecognized arguments: --nonsense; see 'testudo bag rates --help'\n",
        ),
        (
            ["demo", "--seed", "x"],
            "--seed: error: 'x' is not a whole number of 0 or more; see 'testudo demo --help'\n",
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


def test_a_command_that_is_not_there_is_refused_with_those_that_are(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["chek"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("COMMAND: error: invalid choice: 'chek'")
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


NOT_FOR_A_PLAIN_RUN = (
    *(
        "bags",
        "incidents.live_incidents",
        "incidents.live_outages",
        "incidents.recorder",
        "robot.rule_checking",
    ),
    *(
        "domain.link",
        "domain.questions",
        "link.openmetrics.run_metrics",
        "link.parts.live_link",
        "link.protocol",
    ),
    *("link.parts.command_subscribers", "link.zenoh", "optimizer.model", "rules.profile_file"),
)
"""What only recording, large rules, a link, metrics, levels or a profile need."""
HEAVY = (
    "asyncio",
    "decimal",
    "fractions",
    "multiprocessing",
    "pickle",
    "statistics",
    "subprocess",
    "tomllib",
)


def imported_by(program: str, folder: Path) -> list[str]:
    """The modules that ``program`` imports for the file of plain rules that it gets."""
    rules = folder / "plain.adirf"
    rules.write_text("begin SetFrequency /odom 10 end", encoding="utf-8")
    whole = f"import sys; before = set(sys.modules)\n{program}\nprint(*sorted(set(sys.modules) - before))"
    done = subprocess.run(
        [sys.executable, "-c", whole, str(rules)], capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()[-1].split()


def unasked(imported: list[str], names: tuple[str, ...]) -> list[str]:
    """The modules among ``imported`` that are slow to import, or one of our ``names`` or in it."""
    ours = (f"smarttestudo.{name}" for name in names)
    parts = tuple(f"{name}." for name in (*HEAVY, *ours))
    return [name for name in imported if f"{name}.".startswith(parts)]


def test_a_run_imports_only_what_it_was_asked_for(tmp_path: Path) -> None:
    program = (
        "from smarttestudo.cli.commands import command_parser\n"
        "arguments = command_parser().parse_args(['run', '--rules', sys.argv[1]])\n"
        "from smarttestudo.rules.rule_sets import load_rules\n"
        "load_rules(arguments.rules).refuse_errors()"
    )
    imported = imported_by(program, tmp_path)
    assert "smarttestudo.robot.live_run" in imported
    assert unasked(imported, NOT_FOR_A_PLAIN_RUN) == []


NOT_FOR_A_PLAIN_CHECK = (
    "bags",
    "domain.status",
    "link",
    "optimizer",
    "rules.budget_findings",
    "rules.profile_file",
)
"""What only a profile, a recording or a robot needs."""


def test_a_check_imports_only_what_it_was_asked_for(tmp_path: Path) -> None:
    program = "from smarttestudo.cli.main import main\nassert main(['check', sys.argv[1]]) == 0"
    imported = imported_by(program, tmp_path)
    assert "smarttestudo.checks.registry" in imported
    assert unasked(imported, NOT_FOR_A_PLAIN_CHECK) == []
