# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo fmt``: rule files in the house style."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from smarttestudo.cli.arguments import add_rule_files
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.finding_text import print_findings
from smarttestudo.cli.output import write_file_text, write_line
from smarttestudo.domain.errors import RuleFileError, TestudoError
from smarttestudo.language.formatter import first_line_end, format_file
from smarttestudo.language.parser import MAX_FILE_BYTES, parse
from smarttestudo.rules.rule_files import STANDARD_INPUT, find_rule_files, read_rule_text, write_rule_text

EXIT_ERROR = 1


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Format rule files in place, and standard input (-) to standard output: comments, order and meaning "
        "stay. A file with errors is left as it is."
    )
    add_rule_files(parser)
    parser.add_argument(
        "--check", action="store_true", help="write nothing; list the files that would change"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Format every file that can be; 1 if one could not, or would change with ``--check``."""
    is_check: bool = arguments.check
    code = 0
    for path in arguments.files:
        try:
            files = find_rule_files([path])
        except RuleFileError as error:
            write_line(str(error), sys.stderr)
            code = EXIT_ERROR
            continue
        for file in files:
            code = max(code, _format(file, is_check=is_check))
    return code


def _require_readable(path: Path, formatted: str) -> None:
    if len(formatted.encode()) > MAX_FILE_BYTES:
        cause = "the rule file would be larger than 4 MB in the house style"
        raise RuleFileError(cause, place=str(path), remedy="it is left as it is; split it into several")


def _format(path: Path, *, is_check: bool) -> int:
    try:
        text = read_rule_text(path)
        result = parse(text, str(path))
        if not result.is_valid:
            print_findings(result.findings, {str(path): text}, sys.stderr)
            return EXIT_ERROR
        formatted = format_file(result.file, line_end=first_line_end(text))
        if path is STANDARD_INPUT and not is_check:
            _require_readable(path, formatted)
            _write_formatted(formatted)
            return 0
        if formatted == text:
            return 0
        _require_readable(path, formatted)
        if not is_check:
            write_rule_text(path, formatted)
    except TestudoError as error:
        write_line(str(error), sys.stderr)
        return EXIT_ERROR
    write_line(str(path) if is_check else f"formatted {path}")
    return EXIT_ERROR if is_check else 0


def _write_formatted(text: str) -> None:
    """Write ``text`` to standard output, in UTF-8 as rule files are, whatever a pipe is said to take."""
    if sys.stdout.isatty():
        write_file_text(text)
    else:
        sys.stdout.buffer.write(text.encode())
