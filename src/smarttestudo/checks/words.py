# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Checks that compare with a text, true, false or a constant, by what is known of types."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.checks import wording
from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.rule_model import RuleModel
from smarttestudo.domain.finding import Fix, Severity, Span
from smarttestudo.domain.names import is_source
from smarttestudo.domain.signal import SignalKind
from smarttestudo.domain.type_definition import FieldType
from smarttestudo.language.formatter import number_text, value_text
from smarttestudo.language.parser.cursor import closest, did_you_mean
from smarttestudo.language.properties.field_path import ANY
from smarttestudo.language.resolved_rules import ResolvedCheck
from smarttestudo.language.syntax import Compared, Constant


@lint_rule("wrong-type", Severity.ERROR)
def wrong_type(rules: RuleModel) -> Iterator[Found]:
    """A check compares a text with what is a number, or true, false or a constant with what is none.

    The check would stay unknown, and its block never decide. The type of the topic is known from the
    profile, a recording or a robot. What `@machine` and `@link` have are numbers, but for `connected`.
    """
    for check in rules.checks:
        field = _field(check, rules)
        value = check.syntax.value
        if field is None or field.is_message or not isinstance(value, str | bool):
            continue
        if not (field.is_text if isinstance(value, str) else field.is_truth):
            message = f"{value_text(value)} is compared with {check.signal}, which is a {field.name} here"
            yield _found(check, message, right=_meant(value, field), hint="compare it with one of that type")


def _found(check: ResolvedCheck, message: str, *, right: str, hint: str) -> Found:
    """A finding on the value that a check compares with; ``right`` is the one that may be meant, or empty."""
    span = _value_span(check)
    return Found(
        path=check.path,
        span=span,
        message=message,
        hint=did_you_mean(right) if right else hint,
        fix=Fix(span=span, replacement=right, title=f"write {right}") if right else None,
        related=(check.syntax.property_span,),
    )


def _meant(value: Compared, field: FieldType) -> str:
    """The value of the field's type that may be meant, as a rule file writes it."""
    if field.is_text:
        return value_text(str(value).lower())
    if isinstance(value, bool):
        return number_text(float(value))
    word = str(value).strip().casefold()
    if field.is_truth:
        return word if word in ("true", "false") else ""
    try:
        return number_text(float(word))
    except ValueError:
        return ""


def _field(check: ResolvedCheck, rules: RuleModel) -> FieldType | None:
    """The field that a check reads, where its topic's type is known for certain; an element of an array."""
    if is_source(check.signal.topic):
        spec = rules.context.spec_of(check.signal)
        return None if spec is None else FieldType(name="number" if spec.unit else "bool")
    if rules.context.known_type(check.signal.topic) is None:
        return None
    field = rules.context.types.field_at(check.signal.topic, check.syntax.property)
    is_whole = field is not None and field.is_array and not check.syntax.property.endswith("]")
    return None if is_whole else field


def _value_span(check: ResolvedCheck) -> Span:
    """The last word of the comparison, which is on the line where the check or its Until begins or ends."""
    until = check.syntax.until
    if until is not None:
        return check.syntax.span
    end = check.syntax.span
    length = len(check.syntax.text)
    return Span(
        line=end.end_line, column=end.end_column - length, end_line=end.end_line, end_column=end.end_column
    )


@lint_rule("unknown-constant", Severity.ERROR)
def unknown_constant(rules: RuleModel) -> Iterator[Found]:
    """A check compares with a constant that the message's type does not have.

    The type is known from the profile, a recording or a robot, so that nothing could ever be that constant.
    """
    for check, constant in _unresolved(rules):
        names = _constants(check, constant, rules)
        if names:
            close = closest(constant.name, names)
            right = str(Constant(type_name=constant.type_name, name=close)) if close else ""
            message = f"no type of {check.signal.topic} has the constant {constant}"
            yield _found(check, message, right=right, hint=f"there are {wording.listed(names)}")


@lint_rule("unresolved-constant", Severity.WARNING)
def unresolved_constant(rules: RuleModel) -> Iterator[Found]:
    """A check compares with a constant, and no type is known that has it.

    A run on a robot finds it in the type of the topic. Until then the check stays unknown, and where the
    block may hold, the higher rate counts.
    """
    for check, constant in _unresolved(rules):
        if not _constants(check, constant, rules):
            topic = check.signal.topic
            message = f"the type of {topic} is not known, nor what {constant} is"
            hint = f"write the number, or {rules.context.way_to_profile}"
            if is_source(topic):
                message, hint = f"{topic} has no constant {constant}", "write a number, true or false"
            yield _found(check, message, right="", hint=hint)


def _unresolved(rules: RuleModel) -> Iterator[tuple[ResolvedCheck, Constant]]:
    for check in rules.checks:
        compared = [check.syntax.value, *([] if check.syntax.until is None else [check.syntax.until.value])]
        constants = [value for value in compared if isinstance(value, Constant)]
        types = rules.context.types
        lacking = [
            one for one in constants if types.constant(check.signal.topic, check.syntax.property, one) is None
        ]
        if check.signal.kind is SignalKind.UNRESOLVED and lacking:
            yield check, lacking[0]


def _constants(check: ResolvedCheck, constant: Constant, rules: RuleModel) -> tuple[str, ...]:
    """The constants of the types that could have it, where they are known for certain."""
    topic, types = check.signal.topic, rules.context.types
    if not constant.type_name and rules.context.known_type(topic) is None:
        return ()
    found = [
        types.definition(name)
        for name in types.types_with_constants(topic, check.syntax.property, constant.type_name)
    ]
    return tuple(
        dict.fromkeys(name for definition in found if definition is not None for name in definition.constants)
    )


@lint_rule("text-not-in-bag", Severity.INFO)
def text_not_in_bag(rules: RuleModel) -> Iterator[Found]:
    """A check compares with a text that the property never has in the recording given with --bag.

    Mostly it is misspelled, or written with other capitals. It may also be what did not happen there.
    """
    for check in rules.checks:
        observed = rules.context.observed.get(check.signal)
        value = check.syntax.value
        if observed is None or not observed.texts or not isinstance(value, str) or value in observed.texts:
            continue
        close = closest(value, observed.texts)
        message = f"{check.signal} is never {value_text(value)} in the recording"
        seen = wording.listed([*map(value_text, observed.texts)])
        yield _found(check, message, right=value_text(close) if close else "", hint=f"it is {seen}")


@lint_rule("any-of-one", Severity.WARNING)
def any_of_one(rules: RuleModel) -> Iterator[Found]:
    """A check reads any element of what is no array.

    It stays unknown: its block never decides.
    """
    for check in rules.checks:
        before = check.syntax.property.partition(ANY)[0]
        if before == check.syntax.property or rules.context.known_type(check.signal.topic) is None:
            continue
        field = rules.context.types.field_at(check.signal.topic, before)
        if field is not None and not field.is_array:
            yield Found(
                path=check.path,
                span=check.syntax.property_span,
                message=f"{before} of {check.signal.topic} is no array, but a {field.name}",
                hint="leave out [*]",
            )
