# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""New values in the text of a profile, which keeps its comments, its order and all its other keys."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import tomlkit
from tomlkit.items import Comment, Item, Key, Null, Table, Trivia, Whitespace

from smarttestudo.domain.errors import ProfileError
from smarttestudo.domain.texts import without_mark
from smarttestudo.files.toml_text import KeyPath, parse_toml

Value = str | bool | float | Sequence[float] | None
"""The new value of a key; ``None`` takes it out."""

_Body = list[tuple[Key | None, Item]]
_TOPICS = "topics"
_MOST_WHOLE = 1e16


def edited_profile(
    text: str, path: Path, top: Mapping[str, Value], topics: Mapping[str, Mapping[str, Value]]
) -> str:
    """``text`` with the keys ``top`` and, by the name that the text has for them, those of ``topics``.

    Tables of other topics are taken out; keys that are not given stay.

    Raises ``ProfileError`` for a text that is no TOML, or is written so that its tables cannot be edited
    one by one (inline tables, dotted keys).
    """
    values, _ = parse_toml(text, path)
    if _wanted(values, top, topics) == values:
        return text
    mark, written = without_mark(text)
    edited = mark + _edited(written, top, topics)
    try:
        after, _ = parse_toml(edited, path)
    except ProfileError as error:
        raise _too_free(path) from error
    if after != _wanted(values, top, topics):
        raise _too_free(path)
    return edited


def _too_free(path: Path) -> ProfileError:
    return ProfileError(
        "the table cannot edit a profile that is written this way",
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


class _Entry(NamedTuple):
    """A table with a header, by its path, or (without one) any other entry of the list ``body``."""

    body: _Body
    at: int
    path: KeyPath | None

    @property
    def item(self) -> Item:
        """Item at this place."""
        return self.body[self.at][1]

    def replace(self, item: Item) -> None:
        """Put what has no key in its place; the indices of others stay."""
        self.body[self.at] = (None, item)


def _entries(body: _Body, path: KeyPath = ()) -> Iterator[_Entry]:
    """All entries, in the order of the text."""
    for index, (key, item) in enumerate(body):
        if not isinstance(item, Table) or key is None or key.is_dotted():
            yield _Entry(body, index, None)
            continue
        if not item.is_super_table():
            yield _Entry(body, index, (*path, key.key))
        yield from _entries(item.value.body, (*path, key.key))


def _edited(text: str, top: Mapping[str, Value], topics: Mapping[str, Mapping[str, Value]]) -> str:
    ending = "\r\n" if "\r\n" in text else "\n"
    document = tomlkit.parse(text if not text or text.endswith("\n") else text + ending)
    entries = list(_entries(document.body))
    tables = {entry.path[1]: at for at, entry in enumerate(entries) if entry.path and _is_topic(entry.path)}
    # From the last to the first: a table ends with the comment of the next one.
    for name in reversed([name for name in tables if name not in topics]):
        _remove_table(entries, tables[name])
    new_tables = []
    for name, keys in topics.items():
        if name in tables:
            _set_keys(_body(entries[tables[name]].item), keys, ending)
        else:
            new_tables.append(_new_table(name, keys))
    _set_keys(document.body, top, ending)
    new_text = "".join(f"\n{table}" for table in new_tables).replace("\n", ending)
    return (document.as_string() + new_text).lstrip("\r\n")


def _is_topic(path: KeyPath) -> bool:
    return len(path) == 2 and path[0] == _TOPICS


def _remove_table(entries: Sequence[_Entry], at: int) -> None:
    """Take out a table with the comments directly above it; what ends it belongs to the next one."""
    removed = entries[at]
    body = _body(removed.item)
    removed.replace(Whitespace("".join(item.as_string() for _, item in body[_end_of_keys(body) :])))
    for kind in (Comment, Whitespace):
        while at and isinstance(entries[at - 1].item, kind):
            entries[at - 1].replace(Null())
            at -= 1


def _body(table: Item) -> _Body:
    return table.value.body if isinstance(table, Table) else []


def _end_of_keys(body: _Body) -> int:
    """Where the blank lines and comments begin that come after the last key and before the next table."""
    for index in reversed(range(len(body))):
        key, item = body[index]
        if key is not None and not isinstance(item, Table):
            return index + 1
    return 0


def _set_keys(body: _Body, keys: Mapping[str, Value], ending: str) -> None:
    """Change those whose value is another one; a comment behind a value stays, new keys come last."""
    end = _end_of_keys(body)
    places = {key.key: index for index, (key, _) in enumerate(body) if key is not None}
    added: _Body = []
    for name, value in keys.items():
        at = places.get(name)
        if at is None:
            if value is not None:
                added.append((tomlkit.key(name), _item(value, Trivia(trail=ending))))
        elif value is None:
            body[at] = (None, Null())
        elif body[at][1].unwrap() != _plain(value):
            body[at] = (body[at][0], _item(value, body[at][1].trivia))
    body[end:end] = added


def _new_table(name: str, keys: Mapping[str, Value]) -> str:
    table = tomlkit.table()
    table.update({key: _plain(value) for key, value in keys.items() if value is not None})
    topics = tomlkit.table(is_super_table=True)
    topics.append(tomlkit.key(name), table)
    return tomlkit.document().append(_TOPICS, topics).as_string()


def _item(value: str | float | Sequence[float], trivia: Trivia) -> Item:
    """``value`` with the blanks and the comment of ``trivia``."""
    item = tomlkit.item(_plain(value))
    for name in ("indent", "comment_ws", "comment", "trail"):
        setattr(item.trivia, name, getattr(trivia, name))
    return item


def _plain(value: str | float | Sequence[float]) -> str | bool | float | list[float]:
    """``value`` as it is written; a whole number without ``.0``."""
    if isinstance(value, str | bool):
        return value
    if isinstance(value, int | float):
        return _number(value)
    return [_number(item) for item in value]


def _number(value: float) -> float:
    return int(value) if float(value).is_integer() and abs(value) < _MOST_WHOLE else float(value)
