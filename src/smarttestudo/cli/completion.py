# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo completion``: a file from which a shell completes command lines, without starting Python."""

from __future__ import annotations

import argparse
import re
import shlex
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from smarttestudo.cli.commands import CommandParser, command_parser
from smarttestudo.cli.output import write_file_text

Meanings = Mapping[str, str]
"""What words and options mean."""
Case = Callable[[str, Meanings, Meanings], str]
"""Writes what may follow some words, words and options, as a case of a shell."""

_CHOICES = re.compile(r"\{(.+)\}")
_BASH = """\
# Completion of testudo in bash, written by 'testudo completion bash'.
_testudo() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}}
    local at=testudo word words options
    # The = of --option=value is a word here.
    [[ $current == = ]] && current=
    [[ $before == = ]] && before=${{COMP_WORDS[COMP_CWORD - 2]}}
    for word in "${{COMP_WORDS[@]:1:COMP_CWORD - 1}}"; do
        case "$at $word" in
            {commands}) at+=" $word" ;;
        esac
    done
    case "$at $before" in
{values}
        *)
            case $at in
{followers}
            esac
            [[ $current == -* ]] && words=$options
            ;;
    esac
    COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
# Where none of these fits, there may be a file.
complete -o bashdefault -o default -F _testudo testudo
"""
_ZSH = """\
#compdef testudo
# Completion of testudo in zsh, written by 'testudo completion zsh'.
_testudo() {{
    local before=$words[CURRENT-1] at=testudo word
    local -a found options
    for word in $words[2,CURRENT-1]; do
        case "$at $word" in
            ({commands}) at+=" $word" ;;
        esac
    done
    compset -P '--*=' && before=${{words[CURRENT]%%=*}}
    case "$at $before" in
{values}
        (*)
            case $at in
{followers}
            esac
            [[ $PREFIX == -* ]] && found=($options)
            ;;
    esac
    # Where there are none of these, there may be a file.
    if (( $#found )); then _describe testudo found; else _files; fi
}}
if [[ $funcstack[1] == _testudo ]]; then _testudo "$@"; else compdef _testudo testudo; fi
"""


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Print what bash or zsh needs to complete commands, options and their values, to keep in a file "
        "that the shell reads."
    )
    parser.add_argument("shell", choices=tuple(_SHELLS), help="the shell")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the file."""
    template, case = _SHELLS[arguments.shell]
    write_file_text(_script(template, case, list(_completed(command_parser()))))
    return 0


@dataclass(frozen=True, slots=True, kw_only=True)
class CompletedCommand:
    """Words and options that may follow ``path``, the words of a command, each with what it means.

    ``values`` has the choices of each option that takes a value; without any it may be a file.
    """

    path: str
    words: dict[str, str] = field(default_factory=dict)
    options: dict[str, str] = field(default_factory=dict)
    values: dict[str, Sequence[str]] = field(default_factory=dict)


def _completed(parser: CommandParser) -> Iterator[CompletedCommand]:
    """The command of ``parser``, then those below it."""
    parser.fill()
    command = CompletedCommand(path=parser.prog)
    below: list[CommandParser] = []
    for action in parser._actions:  # noqa: SLF001  argparse has no other name for it
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001
            below += action.choices.values()
            command.words.update({one.dest: one.help or "" for one in action._get_subactions()})  # noqa: SLF001
        elif action.option_strings:
            meaning = (action.help or "") % {**vars(action), "prog": parser.prog}
            command.options.update(dict.fromkeys(action.option_strings, meaning))
            if action.nargs != 0:
                command.values.update(dict.fromkeys(action.option_strings, _choices(action)))
        else:
            command.words.update(dict.fromkeys(_choices(action), ""))
    yield command
    for one in below:
        yield from _completed(one)


def _choices(action: argparse.Action) -> Sequence[str]:
    """Values that ``action`` takes, if it names them; options of a run do so in their metavar only."""
    if action.choices is not None:
        return [str(one) for one in action.choices]
    written = _CHOICES.fullmatch(str(action.metavar))
    return written[1].split(",") if written else ()


def _bash_case(words: str, follow: Meanings, options: Meanings) -> str:
    return f"""\"{words}\") words='{" ".join(follow)}' options='{" ".join(options)}' ;;"""


def _zsh_case(words: str, follow: Meanings, options: Meanings) -> str:
    return f'("{words}") found=({_described(follow)}) options=({_described(options)}) ;;'


def _described(words: Meanings) -> str:
    """Words with what they mean, as ``_describe`` takes them."""
    return " ".join(
        shlex.quote(f"{word}:{' '.join(meaning.split())}".removesuffix(":"))
        for word, meaning in words.items()
    )


def _script(template: str, case: Case, commands: Sequence[CompletedCommand]) -> str:
    values = [
        case(f"{command.path} {option}", dict.fromkeys(choices, ""), {})
        for command in commands
        for option, choices in command.values.items()
    ]
    followers = [case(command.path, command.words, command.options) for command in commands]
    return template.format(
        commands="|".join(f'"{command.path}"' for command in commands[1:]),
        values=textwrap.indent("\n".join(values), " " * 8),
        followers=textwrap.indent("\n".join(followers), " " * 16),
    )


_SHELLS: Mapping[str, tuple[str, Case]] = {"bash": (_BASH, _bash_case), "zsh": (_ZSH, _zsh_case)}
