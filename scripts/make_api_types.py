# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Write gui/src/api/types.ts, what page and server say to each other, from structs and records."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, Field, fields, is_dataclass
from enum import Enum
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

from smarttestudo.domain.rate import Tier
from smarttestudo.domain.record import JsonEntry, Mark, derived_entry, json_name, marks
from smarttestudo.ruler.job import Download, Job, Picture, all_jobs
from smarttestudo.ruler.problem import ErrorAnswer
from smarttestudo.ruler.server import live

TYPES = Path(__file__).resolve().parent.parent / "gui" / "src" / "api" / "types.ts"
HEAD = """// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Written by scripts/make_api_types.py (make docs); change the structs and records in Python instead.
"""
LISTS: dict[type[Enum], str] = {Tier: "TIERS"}
"""The closed sets that the page goes through one by one."""
LINE_WIDTH = 120
_WORDS = {
    str: "string",
    int: "number",
    float: "number",
    bool: "boolean",
    type(None): "null",
    object: "unknown",
}


def types_text() -> str:
    """The whole file."""
    jobs = [job for job in all_jobs() if job.answered not in (bytes, Download, Picture)]
    asked: list[type] = [live.Watch, *(job.asked for job in jobs if job.asked is not None)]
    writer = _Writer(_reached(asked))
    for root in (*asked, *(job.answered for job in jobs), ErrorAnswer, live.Push):
        writer.word(root)
    number = f"export const PROTOCOL_VERSION = {live.PROTOCOL_VERSION};"
    protocol = f"/** The protocol of the web socket. */\n{number}\n"
    return "\n".join(
        [HEAD, protocol, *(text for _, text in sorted(writer.written.items())), _routes_text(jobs)]
    )


def _routes_text(jobs: Sequence[Job[..., Any]]) -> str:
    lines = ["/** What each route is asked and answers. */", "export interface Routes {"]
    for job in jobs:
        asked = "null" if job.asked is None else job.asked.__name__
        lines.append(f'  "{job.route}": {{ asked: {asked}; answered: {job.answered.__name__} }};')
    return "\n".join([*lines, "}", ""])


class _Writer:
    """Writes types by name, each once; what a request may leave out is optional."""

    def __init__(self, asked: set[type]) -> None:
        self.written: dict[str, str] = {}
        self._asked = asked

    def word(self, kind: Any) -> str:
        """How TypeScript calls ``kind``."""
        if kind in _WORDS:
            return _WORDS[kind]
        name = _alias(kind)
        if name is not None:
            self._write(name, lambda: _union_text(name, self._terms(kind)))
            return name
        origin, arguments = get_origin(kind), get_args(kind)
        if origin is Literal:
            return " | ".join(f'"{one}"' for one in arguments)
        if origin in (Union, UnionType):
            return " | ".join(self._optional_terms(kind))
        if origin is Annotated:
            word = self.word(arguments[0])
            return f"{word} | null" if Mark.NULL_IS_INFINITE in arguments else word
        if origin in (tuple, frozenset, Sequence):
            if origin is not tuple or arguments[-1] is ...:
                return _list_of(self.word(arguments[0]))
            return f"[{', '.join(map(self.word, arguments))}]"
        if origin in (dict, Mapping):
            return f"Record<{self.word(arguments[0])}, {self.word(arguments[1])}>"
        return self._named(kind)

    def _named(self, kind: Any) -> str:
        if not isinstance(kind, type):
            raise TypeError(f"{kind} has no word in TypeScript")
        name = kind.__name__
        if issubclass(kind, Enum):
            self._write(name, lambda: _enum_text(kind))
        elif issubclass(kind, msgspec.Struct):
            self._write(name, lambda: self._struct_text(kind))
        elif hasattr(kind, "to_json"):
            return self.word(get_type_hints(kind.to_json)["return"])
        elif is_dataclass(kind):
            self._write(name, lambda: _interface_text(kind, self._record_lines(kind)))
        else:
            raise TypeError(f"{kind} has no word in TypeScript")
        return name

    def _write(self, name: str, text: Any) -> None:
        if name not in self.written:
            self.written[name] = ""
            self.written[name] = text()

    def _terms(self, kind: Any) -> list[str]:
        if get_origin(kind) is Literal:
            return [f'"{one}"' for one in get_args(kind)]
        return [self.word(one) for one in get_args(kind)]

    def _optional_terms(self, kind: Any) -> Iterator[str]:
        known = tuple(one for one in get_args(kind) if one is not type(None))
        if len(known) == len(get_args(kind)):
            yield from map(self.word, known)
        else:
            yield self.word(Union[known])  # noqa: UP007  built from a tuple
            yield "null"

    def _struct_text(self, kind: type[msgspec.Struct]) -> str:
        for held in _reached([kind]):
            if is_dataclass(held) and not _stands_by_its_fields(held):
                raise TypeError(f"{kind} holds {held}, which msgspec would write in its own way")
        return _interface_text(kind, self._struct_lines(kind))

    def _struct_lines(self, kind: type[msgspec.Struct]) -> Iterator[str]:
        config = kind.__struct_config__
        if config.tag is not None:
            yield f'  {config.tag_field}: "{config.tag}";'
        hints = get_type_hints(kind)
        for one in msgspec.structs.fields(kind):
            mark = "?" if not one.required and kind in self._asked else ""
            yield f"  {one.encode_name}{mark}: {self.word(hints[one.name])};"

    def _record_lines(self, kind: Any) -> Iterator[str]:
        hints = get_type_hints(kind, include_extras=True)
        for field in fields(kind):
            hint = hints[field.name]
            entry = next((one for one in marks(hint) if isinstance(one, JsonEntry)), JsonEntry())
            if entry.is_merged:
                yield from self._record_lines(get_args(hint)[0])
            elif not (entry.is_absent or entry.is_rest):
                is_left_out = entry.omits_default or (kind in self._asked and _has_default(field))
                mark = "?" if is_left_out else ""
                yield f"  {entry.name or field.name}{mark}: {self._entry_word(hint, entry, field)};"
        for entry, getter in _derived(kind):
            mark = "?" if entry.omits_default else ""
            yield f"  {entry.name}{mark}: {self.word(get_type_hints(getter, include_extras=True)['return'])};"

    def _entry_word(self, hint: Any, entry: JsonEntry, field: Field[Any]) -> str:
        if entry.keyed_by:
            (kind, _) = get_args(get_args(hint)[0])
            return f'Record<string, Omit<{self.word(kind)}, "{entry.keyed_by}">>'
        if entry.are_rows:
            (kind, _) = get_args(get_args(hint)[0])
            hints = get_type_hints(kind, include_extras=True)
            return f"[{', '.join(f'{one.name}: {self.word(hints[one.name])}' for one in fields(kind))}][]"
        word = self.word(hint)
        return word.removesuffix(" | null") if entry.omits_default and field.default is None else word


def _has_default(field: Field[Any]) -> bool:
    return field.default is not MISSING or field.default_factory is not MISSING


def _list_of(word: str) -> str:
    is_tuple = word.startswith("[") and word.endswith("]")
    return f"({word})[]" if " | " in word and not is_tuple else f"{word}[]"


def _interface_text(kind: type, lines: Iterator[str]) -> str:
    return "\n".join([*_comment(kind), f"export interface {kind.__name__} {{", *lines, "}", ""])


def _derived(kind: type) -> Iterator[tuple[JsonEntry, Any]]:
    """The properties that are entries, too."""
    getters = [one.fget for one in vars(kind).values() if isinstance(one, property)]
    return ((entry, one) for one in getters if (entry := derived_entry(one)) is not None)


def _stands_by_its_fields(kind: Any) -> bool:
    """Whether the JSON of a record is its fields by their names, as they are."""
    hints = get_type_hints(kind, include_extras=True)
    return not [*_derived(kind)] and not any(_is_marked(hints[field.name]) for field in fields(kind))


def _is_marked(hint: Any) -> bool:
    if get_origin(hint) is Annotated or hasattr(hint, "to_json"):
        return True
    if isinstance(hint, type) and issubclass(hint, Enum):
        return any(json_name(one) != one.value for one in hint)
    return any(map(_is_marked, get_args(hint)))


def _reached(roots: list[type]) -> set[type]:
    """The structs and records that these can hold."""
    found: set[type] = set()
    waiting: list[Any] = list(roots)
    while waiting:
        kind = waiting.pop()
        waiting.extend(get_args(kind))
        if (
            isinstance(kind, type)
            and kind not in found
            and (is_dataclass(kind) or issubclass(kind, msgspec.Struct))
        ):
            found.add(kind)
            waiting.extend(get_type_hints(kind).values())
    return found


def _alias(kind: Any) -> str | None:
    """The name that a module of the Ruler gives a union; ``None`` for one without."""
    if get_origin(kind) not in (Union, UnionType, Literal):
        return None
    modules = [module for name, module in sorted(sys.modules.items()) if name.startswith(_PLACES)]
    names = {name for module in modules for name, value in vars(module).items() if _is_same(value, kind)}
    return min(names) if names else None


_PLACES = "smarttestudo.ruler."


def _is_same(value: object, kind: Any) -> bool:
    return get_origin(value) in (Union, UnionType, Literal) and set(get_args(value)) == set(get_args(kind))


def _union_text(name: str, terms: list[str]) -> str:
    line = f"export type {name} = {' | '.join(terms)};"
    if len(line) > LINE_WIDTH:
        line = f"export type {name} =\n" + "\n".join(f"  | {term}" for term in terms) + ";"
    return line + "\n"


def _enum_text(kind: type[Enum]) -> str:
    values = [f'"{json_name(one)}"' for one in kind]
    comment = "\n".join(_comment(kind))
    if kind not in LISTS:
        return f"{comment}\n{_union_text(kind.__name__, values)}"
    name = LISTS[kind]
    return (
        f"{comment}\nexport const {name} = [{', '.join(values)}] as const;\n"
        f"export type {kind.__name__} = (typeof {name})[number];\n"
    )


def _comment(kind: type) -> Iterator[str]:
    lines = re.sub("``(.*?)``", r"`\1`", kind.__doc__ or "").split("\n")
    shown = [line.strip() for line in lines]
    while shown and not shown[-1]:
        shown.pop()
    if len(shown) == 1:
        yield f"/** {shown[0]} */"
        return
    yield "/**"
    yield from (f" * {line}".rstrip() for line in shown)
    yield " */"


def main() -> None:
    """Write the file."""
    TYPES.write_text(types_text(), encoding="utf-8")
    print(f"wrote {TYPES}")


if __name__ == "__main__":
    main()
