# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Cases of lint rules: for each, rule files that it finds something in and others in which it does not.

A file of ``cases``, one a theme, is ADIRF with headings in its comments. ``// # code`` begins the cases
of a lint rule, ``// ## bad`` and ``// ## good`` an example; the comments below that are its ``profile`` in
TOML, its ``recording`` (a topic and its type), the ``texts`` that a property has there, and each ``finding``
(line, column and message) that it gives, one a line.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

FOLDER = Path(__file__).parent / "cases"
_LINT_RULE, _EXAMPLE, _NOTE = "// # ", "// ## ", "//"


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    """A rule file to show, with the TOML of a profile and the topics of a recording that it is checked with.

    ``findings`` are as in ``3:5 message``; a good example has none.
    """

    rules: str
    profile: str = ""
    bag_topics: Mapping[str, str] | None = None
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    findings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class LintCases:
    """Examples of the lint rule ``code``: ``bad`` give this finding and no other, ``good`` none at all."""

    code: str
    bad: tuple[Example, ...]
    good: tuple[Example, ...]


def read_cases(theme: str) -> tuple[LintCases, ...]:
    """The cases of the lint rules of a theme, in the order of its file.

    Raises ``ValueError`` for a heading or note that is none.
    """
    lines = (FOLDER / f"{theme}.adirf").read_text(encoding="utf-8").splitlines()
    return tuple(_lint_cases(code, part) for code, part in _parts(lines, _LINT_RULE) if code)


def _lint_cases(code: str, lines: Sequence[str]) -> LintCases:
    _, *examples = _parts(lines, _EXAMPLE)
    found: dict[str, list[Example]] = {"bad": [], "good": []}
    for kind, part in examples:
        if kind not in found:
            raise ValueError(f"{code}: an example is bad or good, not {kind}")
        found[kind].append(_example(part))
    return LintCases(code=code, bad=tuple(found["bad"]), good=tuple(found["good"]))


def _example(lines: Sequence[str]) -> Example:
    notes: dict[str, list[str]] = {"profile": [], "recording": [], "texts": [], "finding": []}
    rules = list(lines)
    while rules and rules[0].startswith(_NOTE):
        kind, _, text = rules.pop(0).removeprefix(_NOTE).strip().partition(" ")
        if kind not in notes:
            raise ValueError(f"an example has no {kind}")
        notes[kind].append(text)
    return Example(
        rules="\n".join(rules).rstrip("\n") + "\n",
        profile="\n".join(notes["profile"]),
        bag_topics=dict(line.split(" ") for line in notes["recording"]) or None,
        texts={signal: tuple(words.split(", ")) for signal, words in map(_split, notes["texts"])},
        findings=tuple(notes["finding"]),
    )


def _split(note: str) -> tuple[str, str]:
    signal, _, words = note.partition(": ")
    return signal, words


def _parts(lines: Sequence[str], heading: str) -> Iterator[tuple[str, Sequence[str]]]:
    """The parts of ``lines`` by their heading, first what stands before any, with an empty one."""
    starts = [at for at, line in enumerate(lines) if line.startswith(heading)]
    yield "", lines[: starts[0] if starts else None]
    for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
        yield lines[start].removeprefix(heading), lines[start + 1 : end]
