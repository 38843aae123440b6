# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Hypothesis strategies of rule files as texts, in any layout with comments anywhere."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cache
from random import Random

from hypothesis import strategies as st

from language.wide_rules import wide_rule_files
from smarttestudo.domain.rate import Tier
from smarttestudo.language.parser.lexer import KEYWORDS, NEVER_GLUED
from smarttestudo.language.syntax import (
    Action,
    And,
    Block,
    CallService,
    Check,
    Condition,
    DurationUnit,
    Group,
    KeepAtLeast,
    KeepWithin,
    Not,
    Or,
    RecordIncident,
    RuleFile,
    SetFrequency,
    SetParameter,
    Statement,
    Timed,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Word:
    """A word of a rule file; ``owner`` numbers the statement it is in."""

    text: str
    owner: int


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenFile:
    """A text, the tree it must parse to, its words, and the owner of each of its comments."""

    text: str
    tree: RuleFile
    words: tuple[Word, ...]
    comment_owners: dict[str, int]


@cache
@st.composite
def written_files(draw: st.DrawFn, *, max_statements: int = 5) -> WrittenFile:
    """A rule file in any layout, with comments anywhere."""
    tree = draw(wide_rule_files(max_statements=max_statements))
    words = words_of(tree)
    text, owners = lay_out(words, Random(draw(seeds())))
    return WrittenFile(text=text, tree=tree, words=words, comment_owners=owners)


def words_of(file: RuleFile) -> tuple[Word, ...]:
    """The words of a tree in order, owned by the collection or the innermost statement around them."""
    return tuple(_Speller().file(file))


class _Speller:
    def __init__(self) -> None:
        self._owners = 0

    def file(self, file: RuleFile) -> Iterator[Word]:
        for collection in file.collections:
            owner = self._next_owner()
            yield Word(text="begin", owner=owner)
            for statement in collection.statements:
                yield from self._statement(statement)
            yield Word(text="end", owner=owner)

    def _next_owner(self) -> int:
        self._owners += 1
        return self._owners

    def _statement(self, statement: Statement | Action) -> Iterator[Word]:
        owner = self._next_owner()
        if isinstance(statement, Block):
            yield from self._block(statement, owner)
        elif isinstance(statement, KeepWithin):
            bound = statement.bound.value if isinstance(statement.bound, Tier) else statement.text
            words = ["KeepWithin", statement.topic.text, statement.property, bound]
            yield from _owned(words, owner)
        elif isinstance(statement, RecordIncident):
            yield from _owned(["Record", _quoted(statement.name)], owner)
            yield from _owned([topic.text for topic in statement.topics], owner)
            for keyword, duration in (("Before", statement.before), ("After", statement.after)):
                yield from _owned([keyword, duration.text, duration.unit.value], owner)
        elif isinstance(statement, SetFrequency | KeepAtLeast):
            keyword = type(statement).__name__
            unit = ["Hz"] if statement.rate.has_unit else []
            value = statement.rate.value
            rate = value.value if isinstance(value, Enum) else statement.rate.text
            yield from _owned([keyword, statement.topic.text, rate, *unit, *_margin_words(statement)], owner)
        elif isinstance(statement, SetParameter):
            words = [statement.node.text, statement.parameter, statement.text]
            yield from _owned(["SetParameter", *words], owner)
        elif isinstance(statement, CallService):
            argument = [] if statement.argument is None else [str(statement.argument).lower()]
            yield from _owned(["Call", statement.service.text, *argument], owner)
        else:
            yield from _owned(["Notify", _quoted(statement.text)], owner)

    def _block(self, block: Block, owner: int) -> Iterator[Word]:
        if block.is_disabled:
            yield Word(text="Disabled", owner=owner)
        if block.name is not None:
            yield from _owned(["Rule", _quoted(block.name)], owner)
        if block.priority is not None:
            yield from _owned(["Priority", str(block.priority)], owner)
        yield from _owned(["If", *_condition_words(block.condition), "Then"], owner)
        for statement in block.then:
            yield from self._statement(statement)
        if block.otherwise:
            yield Word(text="Else", owner=owner)
        for statement in block.otherwise:
            yield from self._statement(statement)
        if block.has_end_if:
            yield Word(text="EndIf", owner=owner)


def _margin_words(statement: SetFrequency | KeepAtLeast) -> list[str]:
    margin = statement.margin if isinstance(statement, SetFrequency) else None
    if margin is None:
        return []
    value = margin.to.value
    end = [
        value.value if isinstance(value, Enum) else margin.to.text,
        *(["Hz"] if margin.to.has_unit else []),
    ]
    read = [margin.topic.text, margin.property]
    return ["..", *end, "By", *read, margin.from_text, "..", margin.to_text]


def _quoted(name: str) -> str:
    escaped = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def _owned(texts: Sequence[str], owner: int) -> Iterator[Word]:
    return (Word(text=text, owner=owner) for text in texts)


def _condition_words(condition: Condition) -> list[str]:
    match condition:
        case Check():
            name, operator = condition.property, condition.operator.value
            until = condition.until
            ending = [] if until is None else ["Until", until.operator.value, until.text]
            return ["CheckValue", condition.topic.text, name, operator, condition.text, *ending]
        case Not():
            return ["Not", *_condition_words(condition.operand)]
        case Timed():
            time = [condition.word.value, condition.duration.text, condition.duration.unit.value]
            return [*_condition_words(condition.operand), *time]
        case Group():
            return ["(", *_condition_words(condition.operand), ")"]
        case And() | Or():
            connective = "AND" if isinstance(condition, And) else "OR"
            parts = [[connective, *_condition_words(operand)] for operand in condition.operands]
            return [word for part in parts for word in part][1:]


@cache
def seeds() -> st.SearchStrategy[int]:
    """Of layouts: a draw for each blank would take Hypothesis minutes to shrink."""
    return st.integers(0, 2**32)


_BLANKS = (" ", " ", " ", "  ", "\t", "\n", "\n", "\r\n", "\n\n", "\n  \n\n", "\r", "\u00a0")


def lay_out(words: Sequence[Word], random: Random) -> tuple[str, dict[str, int]]:
    """The words with random blanks, line ends and comments between them, and who owns each comment.

    A comment on a line of its own belongs to what follows it, another to what is before it; after the last
    word it belongs to nobody, which is owner 0.
    """
    pieces: list[str] = []
    owners: dict[str, int] = {}
    for index, word in enumerate([*words, Word(text="", owner=0)]):
        before = words[index - 1] if index else None
        blank = random.choice(_BLANKS)
        if before is not None and _may_touch(before.text, word.text) and random.random() < 0.5:
            blank = ""
        while random.random() < 0.15:
            comment = f"// c{len(owners)} {random.choice(('', 'If // x', 'end', 'é “”'))}".rstrip()
            is_own_line = before is None or "\n" in blank or "\r" in blank
            owners[comment] = word.owner if is_own_line or before is None else before.owner
            blank += comment + random.choice(("\n", "\r\n", " \n\n"))
        pieces.append(blank + word.text)
    return "".join(pieces), owners


_UNITS = ("Hz", *(unit.value for unit in DurationUnit))


def _may_touch(first: str, second: str) -> bool:
    if {first, second} & {kind.value for kind in NEVER_GLUED}:
        return False
    if first in KEYWORDS and (second in KEYWORDS or second.startswith("/")):
        return True
    return not (_is_of_word(first[-1:]) and _is_of_word(second[:1])) or second in _UNITS


def _is_of_word(character: str) -> bool:
    return character.isalnum() or (character != "" and character in "_~/.+-[]*@")
