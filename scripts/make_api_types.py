# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Write gui/src/api/types.ts, what page and server say to each other, from the structs of the server."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import partial
from pathlib import Path
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

from smarttestudo.domain.rate import Tier
from smarttestudo.robot.ros import open_graph_robots
from smarttestudo.ruler.answers.robot_incidents import RobotIncidents
from smarttestudo.ruler.answers.robot_link import RobotLink
from smarttestudo.ruler.project.project_folder import ProjectFolder
from smarttestudo.ruler.server import socket
from smarttestudo.ruler.server.app import api_routes, keeping_routes, robot_incident_routes
from smarttestudo.ruler.server.errors import ErrorAnswer
from smarttestudo.ruler.server.keeping import Keepings
from smarttestudo.ruler.server.routes import ApiRoute

TYPES = Path(__file__).resolve().parent.parent / "gui" / "src" / "api" / "types.ts"
HEAD = """// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Written by scripts/make_api_types.py (make docs); change the structs of the server instead.
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
    project = ProjectFolder(Path())
    routes = [
        *api_routes(project, RobotLink(partial(open_graph_robots, "")), socket.Listeners()),
        *keeping_routes(Keepings(project)),
        *robot_incident_routes(RobotIncidents(project, None)),
    ]
    asked = [socket.Watch, *(route.asked for route in routes if route.asked is not None)]
    writer = _Writer(_reached(asked))
    for root in (*asked, *(route.answered for route in routes), ErrorAnswer, socket.Push):
        writer.word(root)
    number = f"export const PROTOCOL_VERSION = {socket.PROTOCOL_VERSION};"
    protocol = f"/** The protocol of the web socket. */\n{number}\n"
    return "\n".join(
        [HEAD, protocol, *(text for _, text in sorted(writer.written.items())), _routes_text(routes)]
    )


def _routes_text(routes: list[ApiRoute]) -> str:
    lines = ["/** What each route is asked and answers. */", "export interface Routes {"]
    for route in routes:
        asked = "null" if route.asked is None else route.asked.__name__
        lines.append(
            f'  "{route.method} {route.path}": {{ asked: {asked}; answered: {route.answered.__name__} }};'
        )
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
        if origin is tuple:
            if arguments[-1] is ...:
                word = self.word(arguments[0])
                return f"({word})[]" if " | " in word else f"{word}[]"
            return f"[{', '.join(map(self.word, arguments))}]"
        if origin is dict:
            return f"Record<{self.word(arguments[0])}, {self.word(arguments[1])}>"
        return self._named(kind)

    def _named(self, kind: type) -> str:
        name = kind.__name__
        if issubclass(kind, Enum):
            self._write(name, lambda: _enum_text(kind))
        elif issubclass(kind, msgspec.Struct) or is_dataclass(kind):
            self._write(name, lambda: self._interface_text(kind))
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
        yield self.word(Union[known])  # noqa: UP007  built from a tuple
        if len(known) < len(get_args(kind)):
            yield "null"

    def _interface_text(self, kind: type) -> str:
        lines = [*_comment(kind), f"export interface {kind.__name__} {{"]
        config = getattr(kind, "__struct_config__", None)
        if config is not None and config.tag is not None:
            lines.append(f'  {config.tag_field}: "{config.tag}";')
        hints = get_type_hints(kind)
        for name, encoded, has_default in _fields(kind):
            mark = "?" if has_default and kind in self._asked else ""
            lines.append(f"  {encoded}{mark}: {self.word(hints[name])};")
        return "\n".join([*lines, "}", ""])


def _fields(kind: type) -> Iterator[tuple[str, str, bool]]:
    """The name of each field, its name in JSON, and whether it may be left out."""
    if issubclass(kind, msgspec.Struct):
        for one in msgspec.structs.fields(kind):
            yield one.name, one.encode_name, not one.required
    else:
        for field in fields(kind):
            yield field.name, field.name, field.default is not MISSING or field.default_factory is not MISSING


def _reached(roots: list[type[msgspec.Struct]]) -> set[type]:
    """The structs that a request can hold."""
    found: set[type] = set()
    waiting: list[Any] = list(roots)
    while waiting:
        kind = waiting.pop()
        waiting.extend(get_args(kind))
        if isinstance(kind, type) and kind not in found and issubclass(kind, msgspec.Struct):
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


_PLACES = ("smarttestudo.ruler.answers.", "smarttestudo.ruler.server.")


def _is_same(value: object, kind: Any) -> bool:
    return get_origin(value) in (Union, UnionType, Literal) and set(get_args(value)) == set(get_args(kind))


def _union_text(name: str, terms: list[str]) -> str:
    line = f"export type {name} = {' | '.join(terms)};"
    if len(line) > LINE_WIDTH:
        line = f"export type {name} =\n" + "\n".join(f"  | {term}" for term in terms) + ";"
    return line + "\n"


def _enum_text(kind: type[Enum]) -> str:
    values = [f'"{one.value}"' for one in kind]
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
