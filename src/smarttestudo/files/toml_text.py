# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""TOML files with the line of every key, which the standard reader does not keep."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from pathlib import Path

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.texts import without_mark
from smarttestudo.files.input_file import read_input

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MAX_PROFILE_BYTES = 1_000_000
KeyPath = tuple[str, ...]
_KEY = re.compile(r"\s*([A-Za-z0-9_.\"'/-]+)\s*=")
MAX_KEY_PARTS = 10
_KEY_PART = r"""(?:[A-Za-z0-9_-]+|"[^"\n]*"|'[^'\n]*')"""
# A reader of TOML takes time by the square of the parts of a key.
_DEEP_KEY = re.compile(rf"(?<![A-Za-z0-9_-])(?:{_KEY_PART}[ \t]*\.[ \t]*){{{MAX_KEY_PARTS}}}")
_MANY_DIGITS = re.compile(r"\d[\d_]{999}")
_AT_LINE = re.compile(r"(.*) \(at line (\d+), column (\d+)\)\Z", re.DOTALL)


def parse_toml(text: str, path: Path) -> tuple[dict[str, object], dict[KeyPath, int]]:
    """The values in ``text``, which is that of ``path``, and the line of each table and key by its path.

    A byte order mark in front does not count.

    Raises ``ProfileError`` with the place for what is no TOML.
    """
    _, text = without_mark(text)
    if deep := _DEEP_KEY.search(text):
        raise ProfileError(
            f"a key has more than {MAX_KEY_PARTS} parts",
            place=_place(text, deep, path),
            remedy="is it the right file?",
        )
    try:
        values: dict[str, object] = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        matched = _AT_LINE.match(str(error))
        cause, place = (
            (matched[1], f"{path}:{matched[2]}:{matched[3]}") if matched else (str(error), str(path))
        )
        raise ProfileError(f"not valid TOML: {cause}", place=place) from error
    except ValueError as error:
        raise _too_many_digits(text, path) from error
    except RecursionError as error:
        raise ProfileError(
            "the values nest too deep", place=str(path), remedy="is it the right file?"
        ) from error
    return values, _lines_of_keys(text)


def _too_many_digits(text: str, path: Path) -> ProfileError:
    """Error for a whole number of so many digits that Python does not read it."""
    place = _place(text, _MANY_DIGITS.search(text), path)
    return ProfileError(
        "a number has thousands of digits", place=place, remedy="write it shorter, as in 1500.0"
    )


def _place(text: str, found: re.Match[str] | None, path: Path) -> str:
    return str(path) if found is None else f"{path}:{text.count(chr(10), 0, found.start()) + 1}:1"


def read_toml_text(path: Path) -> str:
    """The text of the file at ``path``. Raises ``ProfileError`` where it cannot be read."""
    try:
        data = read_input(path, MAX_PROFILE_BYTES + 1)
    except OSError as error:
        cause = f"the profile cannot be read: {error.strerror}"
        raise ProfileError(cause, place=str(path), remedy="give the path of a TOML file") from error
    if len(data) > MAX_PROFILE_BYTES:
        raise ProfileError("the profile is larger than 1 MB", place=str(path), remedy="is it the right file?")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ProfileError(
            "the profile is not UTF-8 text", place=str(path), remedy="save it as UTF-8"
        ) from error


def _lines_of_keys(text: str) -> dict[KeyPath, int]:
    lines: dict[KeyPath, int] = {}
    table: KeyPath = ()
    for number, line in enumerate(text.splitlines(), start=1):
        if line.lstrip().startswith("["):
            table = _path_in(line) or table
            lines.setdefault(table, number)
        elif matched := _KEY.match(line):
            key = _path_in(f"{matched[1]} = 0")
            lines.setdefault((*table, *key), number)
    return lines


def _path_in(line: str) -> KeyPath:
    """The keys that one line of TOML opens, outermost first."""
    try:
        value: object = tomllib.loads(line)
    except tomllib.TOMLDecodeError:
        return ()
    path: list[str] = []
    while isinstance(value, Mapping) and value:
        key, value = next(iter(value.items()))
        path.append(key)
    return tuple(path)
