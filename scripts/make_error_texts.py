# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Write docs/reference/errors.md: each text of an error and a warning in the code, with its remedy."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src" / "smarttestudo"
PAGE = ROOT / "docs" / "reference" / "errors.md"
NOTE = "<!-- Written by scripts/make_error_texts.py; change the code instead. -->"
SECTIONS: Mapping[str, Sequence[str]] = {
    "Command lines": ("cli",),
    "Rule files, profiles, missions and maps": (
        "files", "rules", "optimizer", "simulation/route.py", "simulation/messages.py",
        "simulation/physics", "ruler/files",
    ),
    "On a robot": ("robot", "domain"),
    "Over a link": ("link",),
    "Incidents": ("incidents", "actions", "loop"),
    "Recordings": ("bags", "replays", "accuracy", "report"),
    "From Python": ("api.py",),
    "The demo": ("simulation/demo", "simulation/simulate.py"),
    "The Ruler's page": (
        "ruler/rules", "ruler/topics", "ruler/tries", "ruler/robots", "ruler/incidents", "ruler/server",
        "ruler/problem.py", "language", "checks", "editing",
    ),
}  # fmt: skip
"""Folders and files of the code, by where a user meets their texts."""
WARNINGS = re.compile(r"(\.log|get_logger\(\))\.(warning|error)$|\._?(warn|warn_once|say)$")
LEAST_CHARACTERS = 6


@dataclass(frozen=True, slots=True, order=True)
class ErrorText:
    """The cause, and what to do if the line says so; … stands for what differs."""

    cause: str
    remedy: str


def page() -> str:
    """The page."""
    ours = error_classes()
    found = {section: sorted(set(texts_of(folders, ours))) for section, folders in SECTIONS.items()}
    lines = [
        NOTE, "# Error texts", "",
        "This page lists each error and warning of SmartTestudo, for search. An error is one line with the",
        "place, the cause and the remedy. … stands for what differs. An empty second column means that the",
        "text itself says what is expected, or that there is nothing to do: for example, data over a link",
        "that is not understood is dropped and counted. [Troubleshooting](../troubleshooting.md) says more",
        "of the texts that need it. Errors of syntax in rule files explain themselves, and",
        "[findings](checks.md) have pages of their own.", "",
    ]  # fmt: skip
    for section, texts in found.items():
        lines += [f"## {section}", "", "| text | what to do |", "|---|---|"]
        lines += [f"| {cell(text.cause)} | {cell(text.remedy)} |" for text in texts]
        lines.append("")
    return "\n".join(lines)


def cell(text: str) -> str:
    """A text that Markdown leaves as it is."""
    return re.sub(r"([|*<>`\[\]_])", r"\\\1", text)


def texts_of(folders: Sequence[str], ours: frozenset[str]) -> Iterator[ErrorText]:
    """Those in the code of ``folders``, raised as errors of ``ours`` or logged."""
    for folder in folders:
        place = SOURCES / folder
        for path in [place] if place.is_file() else sorted(place.rglob("*.py")):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            constants = assigned(tree.body)
            yield from refusals(tree, constants)
            for node in ast.walk(tree):
                if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Assign):
                    yield from texts_in(node, {**constants, **assigned(ast.walk(node))}, ours)


def refusals(tree: ast.AST, names: Mapping[str, list[ast.expr]]) -> Iterator[ErrorText]:
    """Texts of readers of values, which have {} where the value stands."""
    for call in ast.walk(tree):
        for keyword in call.keywords if isinstance(call, ast.Call) else ():
            if keyword.arg == "refusal":
                yield from (ErrorText(text.replace("{}", "…"), "") for text in readings(keyword.value, names))


def error_classes() -> frozenset[str]:
    """The names of the errors that end as a line."""
    bases = {
        node.name: {ast.unparse(base) for base in node.bases}
        for path in SOURCES.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef) and node.name.endswith("Error")
    }
    # What an option cannot be ends as a line with the option as its place.
    known = {"TestudoError", "OptionValueError"}
    while more := {name for name, above in bases.items() if above & known} - known:
        known |= more
    return frozenset(known)


def assigned(nodes: Iterator[ast.AST] | Sequence[ast.AST]) -> dict[str, list[ast.expr]]:
    """What each name may stand for."""
    values: dict[str, list[ast.expr]] = {}
    for node in nodes:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            values.setdefault(node.targets[0].id, []).append(node.value)
    return values


def texts_in(node: ast.AST, names: Mapping[str, list[ast.expr]], ours: frozenset[str]) -> Iterator[ErrorText]:
    """Those of one function or one assignment."""
    for call in ast.walk(node):
        if not isinstance(call, ast.Call) or not call.args:
            continue
        called = ast.unparse(call.func)
        if called not in ours and not called.endswith("ArgumentTypeError") and not WARNINGS.search(called):
            continue
        remedies = {keyword.arg: keyword.value for keyword in call.keywords}
        remedy = next(iter(readings(remedies.get("remedy"), names)), "")
        for cause in readings(call.args[0], names):
            if len(re.sub(r"\W", "", cause)) >= LEAST_CHARACTERS:
                yield ErrorText(cause, "" if remedy == "…" else remedy)


def readings(value: ast.expr | None, names: Mapping[str, list[ast.expr]]) -> Iterator[str]:
    """How ``value`` can read."""
    match value:
        case None | ast.Constant(value=None):
            return
        case ast.Constant(value=str(text)):
            yield text
        case ast.JoinedStr(values=parts):
            shown = (part.value if isinstance(part, ast.Constant) else "…" for part in parts)
            yield re.sub("…+", "…", "".join(map(str, shown)))
        case ast.IfExp(body=body, orelse=other):
            yield from readings(body, names)
            yield from readings(other, names)
        case ast.Name(id=name) if name in names:
            for one in names[name]:
                if not isinstance(one, ast.Name):
                    yield from readings(one, names)
        case _:
            yield "…"


def main() -> None:
    """Write the page."""
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")


if __name__ == "__main__":
    main()
