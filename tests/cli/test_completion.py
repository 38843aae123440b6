# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Command lines that a shell completes from what ``testudo completion`` prints."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from collections.abc import Sequence

import pytest

from cli.test_command_lines import COMMANDS
from smarttestudo.cli.main import main

_BASH = """\
COMP_WORDS=({line}) COMP_CWORD={last} COMPREPLY=()
_testudo
echo "${{COMPREPLY[@]}}"
"""
_ZSH = """\
words=({line}) CURRENT={current} PREFIX={word}
_testudo
"""
_ZSH_STUBS = """\
compdef() { }
compset() { [[ $PREFIX == --*=* ]] && PREFIX=${PREFIX#*=} }
_describe() { print -r -- ${(M)${found%%:*}:#$PREFIX*} }
_files() { print }
"""
LINES: Sequence[tuple[str, str]] = [
    ("testudo ", " ".join(COMMANDS)),
    ("testudo ch", "check"),
    ("testudo bag ", "info rates bandwidth compare loss accuracy report"),
    ("testudo bag ra", "rates"),
    ("testudo bag rates --lat", "--latency"),
    ("testudo bag rates mission --lat", "--latency"),
    ("testudo incidents f", "fetch"),
    ("testudo check --for", "--format"),
    ("testudo check --format ", "text json"),
    ("testudo check rules.adirf --format j", "json"),
    ("testudo check rules.adirf --format json --prof", "--profile"),
    ("testudo run --when-slow ", "pass repeat"),
    ("testudo run --fallback ex", "exit"),
    ("testudo completion ", "bash zsh"),
    ("testudo -", "-h --help --version"),
    # Files, which the shell completes itself.
    ("testudo check ", ""),
    ("testudo check --profile ", ""),
    ("testudo bag rates ", ""),
    ("testudo check bag ra", ""),
]


def printed(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["completion", shell]) == 0
    return capsys.readouterr().out


def offered(*command: str) -> list[list[str]]:
    """What a shell offers for each line; it sorts that itself."""
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return [sorted(line.split()) for line in done.stdout.splitlines()]


@pytest.mark.contract
def test_bash_completes_commands_options_and_their_choices(capsys: pytest.CaptureFixture[str]) -> None:
    lines = [line.split(" ") for line, _ in LINES]
    # Bash takes the = for a word.
    lines += [["testudo", "check", "--format", "=", ""], ["testudo", "check", "--format", "=", "j"]]
    asked = [_BASH.format(line=shlex.join(words), last=len(words) - 1) for words in lines]
    answers = offered("bash", "-c", printed("bash", capsys) + "\n".join(asked))
    assert answers == [*(sorted(answer.split()) for _, answer in LINES), ["json", "text"], ["json"]]


def test_zsh_completes_commands_options_and_their_choices(capsys: pytest.CaptureFixture[str]) -> None:
    if shutil.which("zsh") is None:
        return
    lines = [line.split(" ") for line, _ in LINES] + [["testudo", "check", "--format=j"]]
    asked = [
        _ZSH.format(line=shlex.join(words), current=len(words), word=shlex.quote(words[-1]))
        for words in lines
    ]
    answers = offered("zsh", "-f", "-c", _ZSH_STUBS + printed("zsh", capsys) + "\n".join(asked))
    assert answers == [*(sorted(answer.split()) for _, answer in LINES), ["json"]]


def test_all_options_of_all_commands_are_completed(capsys: pytest.CaptureFixture[str]) -> None:
    bash = printed("bash", capsys)
    for command in COMMANDS:
        with pytest.raises(SystemExit):
            main([command, "--help"])
        usage = capsys.readouterr().out
        (case,) = (line for line in bash.splitlines() if line.strip().startswith(f'"testudo {command}")'))
        options = set(re.findall(r"^  (?:-\w(?: \S+)?, )?(--[\w-]+)", usage, flags=re.MULTILINE))
        # The quote after the last one is of the shell.
        assert options - set(case.replace("'", " ").split()) == set()
