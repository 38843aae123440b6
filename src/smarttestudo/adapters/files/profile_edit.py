# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""New values in the text of a profile, which keeps its comments, its order and all its other keys."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from smarttestudo.adapters.files.toml_text import KeyPath, parse_toml
from smarttestudo.domain.errors import ProfileError

Value = str | float | Sequence[float] | None
"""What a key is set to; ``None`` takes it out."""

_KEY = re.compile(r"\s*[A-Za-z0-9_.\"'/-]+\s*=\s*")
_TOPICS = "topics"


def edited_profile(
    text: str, path: Path, top: Mapping[str, Value], topics: Mapping[str, Mapping[str, Value]]
) -> str:
    """``text`` with the keys ``top`` and, by the name that the text has for them, those of ``topics``.

    Tables of other topics are taken out; keys that are not given stay.

    Raises ``ProfileError`` for a text that is no TOML, or is written so that its tables cannot be edited
    one by one (inline tables, dotted keys).
    """
    values, lines = parse_toml(text, path)
    if _wanted(values, top, topics) == values:
        return text
    edited = _Editor(text, lines).edit(values, top, topics)
    try:
        after, _ = parse_toml(edited, path)
    except ProfileError as error:
        raise _too_free(path) from error
    if after != _wanted(values, top, topics):
        raise _too_free(path)
    return edited


def _too_free(path: Path) -> ProfileError:
    return ProfileError(
        "the profile is written in a way that a table cannot edit",
        place=str(path),
        remedy='write each topic as a table of its own, [topics."/odom"], or edit the text',
    )


def _wanted(
    values: Mapping[str, object], top: Mapping[str, Value], topics: Mapping[str, Mapping[str, Value]]
) -> dict[str, object]:
    before = values.get(_TOPICS, {})
    tables = before if isinstance(before, Mapping) else {}
    wanted = {**values, **top}
    wanted[_TOPICS] = {name: _merged(tables.get(name, {}), keys) for name, keys in topics.items()} or None
    if wanted[_TOPICS] is None and _TOPICS in values and not before:
        wanted[_TOPICS] = {}
    return {key: value for key, value in wanted.items() if value is not None}


def _merged(table: Mapping[str, object], keys: Mapping[str, Value]) -> dict[str, object]:
    merged = {**table, **{key: list(v) if isinstance(v, tuple) else v for key, v in keys.items()}}
    return {key: value for key, value in merged.items() if value is not None}


class _Editor:
    """Works on lines: ``None`` for one that is taken out, and what is put behind one."""

    def __init__(self, text: str, lines: Mapping[KeyPath, int]) -> None:
        self._ending = "\r\n" if "\r\n" in text else "\n"
        self._lines: list[str | None] = list(text.splitlines())
        self._behind: dict[int, list[str]] = {}
        self._new_tables: list[str] = []
        self._places = lines
        self._headers = sorted(lines[key] for key in lines if self._is_header(lines[key]))

    def _is_header(self, number: int) -> bool:
        return (self._lines[number - 1] or "").lstrip().startswith("[")

    def edit(
        self,
        values: Mapping[str, object],
        top: Mapping[str, Value],
        topics: Mapping[str, Mapping[str, Value]],
    ) -> str:
        first_header = self._headers[0] if self._headers else len(self._lines) + 1
        self._set_keys((), top, values, behind=self._last_used(0, first_header - 1))
        tables = values.get(_TOPICS, {})
        tables = tables if isinstance(tables, Mapping) else {}
        for name in tables:
            if name not in topics:
                self._remove_table((_TOPICS, name))
        for name, keys in topics.items():
            at = (_TOPICS, name)
            if name in tables and at in self._places:
                header = self._places[at]
                end = next((one for one in self._headers if one > header), len(self._lines) + 1)
                self._set_keys(at, keys, tables[name], behind=self._last_used(header, end - 1))
            else:
                self._add_table(name, keys)
        return self._text()

    def _last_used(self, first: int, last: int) -> int:
        """The last line from ``first`` to ``last`` that is neither empty nor a comment, else ``first``."""
        for number in range(last, first, -1):
            line = (self._lines[number - 1] or "").strip()
            if line and not line.startswith("#"):
                return number
        return first

    def _set_keys(
        self, at: KeyPath, keys: Mapping[str, Value], before: Mapping[str, object], *, behind: int
    ) -> None:
        for key, value in keys.items():
            wanted = list(value) if isinstance(value, tuple) else value
            if before.get(key) == wanted:
                continue
            number = self._places.get((*at, key))
            if number is not None:
                self._rewrite(number, value)
            elif value is not None:
                self._behind.setdefault(behind, []).append(f"{key} = {toml_value(value)}")

    def _rewrite(self, number: int, value: Value) -> None:
        line = self._lines[number - 1] or ""
        matched = _KEY.match(line)
        start = matched.end() if matched else 0
        last, end = self._end_of_value(number, start)
        rest = (self._lines[last - 1] or "")[end:]
        for one in range(number, last + 1):
            self._lines[one - 1] = None
        if value is not None:
            self._lines[number - 1] = f"{line[:start]}{toml_value(value)}{rest}"

    def _end_of_value(self, number: int, start: int) -> tuple[int, int]:
        """The line and offset at which the value that starts there ends."""
        depth, quote = 0, ""
        while number <= len(self._lines):
            line = self._lines[number - 1] or ""
            at, end = start, start
            while at < len(line):
                character = line[at]
                if quote:
                    at += 1 if character == "\\" and quote == '"' else 0
                    quote = "" if character == quote else quote
                elif character == "#":
                    break
                elif character in "\"'":
                    quote = character
                else:
                    depth += (character in "[{") - (character in "]}")
                at += 1
                end = at if not character.isspace() or quote else end
            if depth <= 0:
                return number, end
            number, start = number + 1, 0
        return len(self._lines), len(self._lines[-1] or "")

    def _remove_table(self, at: KeyPath) -> None:
        header = self._places.get(at)
        if header is None:
            return
        end = next((one for one in self._headers if one > header), len(self._lines) + 1)
        # Comments directly above the next table belong to it.
        last = self._last_used(header, end - 1)
        first = header
        while first > 1 and (self._lines[first - 2] or "").lstrip().startswith("#"):
            first -= 1
        while first > 1 and self._lines[first - 2] == "":
            first -= 1
        for number in range(first, last + 1):
            self._lines[number - 1] = None

    def _add_table(self, name: str, keys: Mapping[str, Value]) -> None:
        self._new_tables += ["", f"[{_TOPICS}.{json.dumps(name)}]"]
        self._new_tables += [
            f"{key} = {toml_value(value)}" for key, value in keys.items() if value is not None
        ]

    def _text(self) -> str:
        lines = list(self._all_lines())
        while lines and lines[0] == "":
            del lines[0]
        return "".join(f"{line}{self._ending}" for line in lines)

    def _all_lines(self) -> Iterator[str]:
        yield from self._behind.get(0, ())
        for number, line in enumerate(self._lines, start=1):
            if line is not None:
                yield line
            yield from self._behind.get(number, ())
        yield from self._new_tables


def toml_value(value: str | float | Sequence[float]) -> str:
    """``value`` as TOML writes it; a whole number without ``.0``."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, int | float):
        return repr(float(value)).removesuffix(".0")
    return f"[{', '.join(toml_value(one) for one in value)}]"
