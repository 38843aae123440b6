# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lint rules of conditions, from the words of the text to values that no signal has."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

from smarttestudo.checks import wording
from smarttestudo.checks.lint_rule import Found, lint_rule
from smarttestudo.checks.property_doubt import Doubt, doubt_about, found_in, is_text
from smarttestudo.checks.rule_model import RuleModel, check_truth
from smarttestudo.domain.finding import Fix, Severity, Span
from smarttestudo.domain.names import is_source
from smarttestudo.domain.profile import LevelUnit
from smarttestudo.domain.signal import ArrivalProperty, SignalKind, Truth
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S
from smarttestudo.language.formatter import (
    LineWriter,
    check_text,
    number_text,
    time_text,
    value_text,
    write_condition,
)
from smarttestudo.language.normal_form import Every, InRegion, read_check
from smarttestudo.language.parser.cursor import did_you_mean
from smarttestudo.language.properties import PropertySpec
from smarttestudo.language.properties.field_path import MESSAGE_PREFIX
from smarttestudo.language.resolved_rules import ResolvedBlock, ResolvedCheck
from smarttestudo.language.syntax import (
    COMMENT_START,
    And,
    Operator,
    Or,
    Timed,
)
from smarttestudo.language.syntax_walks import (
    checks_in,
    conditions_in,
    records_in,
    times_in,
)
from smarttestudo.language.text_region import common

_EQUALITY_HOLDS = {Operator.EQUAL: "hardly ever", Operator.NOT_EQUAL: "nearly always"}
_ZERO_WHEN_SILENT = (ArrivalProperty.RATE, ArrivalProperty.BANDWIDTH)


@lint_rule("never-a-number", Severity.WARNING)
def never_a_number(rules: RuleModel) -> Iterator[Found]:
    """A check compares a number with a text, a list or a field that the messages do not have.

    The check stays unknown: its block never decides, and as long as it is in doubt the topic gets the
    higher of the rates. With a recording, every message is looked at; else only fields of common types
    are known.
    """
    for check in rules.checks:
        signal, observed = check.signal, rules.context.observed.get(check.signal)
        if ArrivalProperty.of(signal) or doubt_about(signal, rules.context):
            continue
        close = None
        if signal.kind is SignalKind.UNRESOLVED or (observed is not None and observed.texts):
            continue
        if observed is not None and observed.greatest is None:
            close = observed.close
            message = f"the recording has no value of {signal}: {observed.why}"
        elif signal.kind is SignalKind.TEXT or not isinstance(check.syntax.value, float):
            continue
        elif observed is None and is_text(rules.context.type_of(signal.topic), signal.property):
            message = f"{signal} is a text, and no number"
        else:
            continue
        doubt = Doubt(
            message=message,
            hint=did_you_mean(close) if close else "the check stays unknown, and its block never decides",
            close=close,
        )
        yield found_in(check.path, check.syntax.property_span, doubt)


_BATTERY = "sensor_msgs/msg/BatteryState"
_SHARES = ("percentage", f"{MESSAGE_PREFIX}percentage")


@lint_rule("share-as-percent", Severity.WARNING)
def share_as_percent(rules: RuleModel) -> Iterator[Found]:
    """A check compares the percentage of a BatteryState, which is a number of 0 to 1, with one above 1.

    It always holds, or never. The property level is the same in percent, also of a robot that publishes 0
    to 100.
    """
    for check in rules.checks:
        topic, observed = check.signal.topic, rules.context.observed.get(check.signal)
        is_share = check.signal.property in _SHARES and rules.context.type_of(topic) == _BATTERY
        is_percent = rules.context.topic(topic).level_unit is LevelUnit.PERCENT
        greatest = 1.0 if observed is None or observed.greatest is None else observed.greatest
        value = check.syntax.value
        is_above = isinstance(value, float) and value > 1
        if is_share and not is_percent and is_above and greatest <= 1:
            is_seen = observed is not None and observed.greatest is not None
            seen = f", and at most {number_text(greatest)} in the recording" if is_seen else ""
            yield Found(
                path=check.path,
                span=check.syntax.property_span,
                message=f"{check_text(check.syntax)} is about a number of 0 to 1{seen}",
                hint="level is the same in percent",
                fix=Fix(span=check.syntax.property_span, replacement="level", title="write 'level'"),
            )


@lint_rule("check-never-holds", Severity.WARNING)
def check_never_holds(rules: RuleModel) -> Iterator[Found]:
    """A check compares a property with a number that it never reaches.

    The rate that depends on it is never used. A battery level, for example, is in percent, so that 120 is
    above every level.
    """
    return _checks_that_are(Truth.FALSE, "never", rules)


@lint_rule("check-always-holds", Severity.WARNING)
def check_always_holds(rules: RuleModel) -> Iterator[Found]:
    """A check compares a property with a number so that every value passes.

    The check decides nothing. Often the unit differs from the expected one: a battery level, for example,
    is counted in percent.
    """
    return _checks_that_are(Truth.TRUE, "always", rules)


def _checks_that_are(truth: Truth, word: str, rules: RuleModel) -> Iterator[Found]:
    """Checks that are ``truth`` for every value of what they read."""
    spec_of, values_of = cache(rules.context.spec_of), cache(rules.context.domain)
    for check in rules.checks:
        spec = spec_of(check.signal)
        if spec is not None and check_truth(check, values_of(check.signal)) is truth:
            yield Found(
                path=check.path,
                span=check.syntax.span,
                message=f"{check_text(check.syntax)} {word} holds: {_range_text(spec)}",
                hint=_remedy_beside_range(check, rules),
            )


def _range_text(spec: PropertySpec) -> str:
    if spec.minimum is not None and spec.maximum is not None:
        low, high = number_text(spec.minimum), number_text(spec.maximum)
        return f"{spec.name} lies between {low} and {high} {spec.unit}".rstrip()
    if spec.minimum is not None:
        return f"{spec.name} is never below {number_text(spec.minimum)} {spec.unit}"
    if spec.maximum is not None:
        return f"{spec.name} is never above {number_text(spec.maximum)} {spec.unit}"
    return f"{spec.name} is in {spec.unit}"


def _remedy_beside_range(check: ResolvedCheck, rules: RuleModel) -> str:
    name = check.signal.property
    if is_source(check.signal.topic):
        return "correct the number"
    if ArrivalProperty.named(name):
        return f"a field of the message that is called {name} is written msg.{name}"
    if rules.context.known_type(check.signal.topic) is None:
        return f"if {name} is a plain field of {check.signal.topic}, write msg.{name}"
    return "correct the number"


@lint_rule("condition-never-holds", Severity.WARNING)
def condition_never_holds(rules: RuleModel) -> Iterator[Found]:
    """A condition contradicts itself.

    The block's Then has no effect; its Else, if there is one, always applies.
    """
    for block in rules.blocks:
        records = bool(records_in(block.block.otherwise))
        if rules.analysis.truths[block.order] is Truth.FALSE and (records or not _is_one_check(block)):
            impossible = _impossible_signals(block, rules)
            reason = f": no value of {impossible} passes all its checks" if impossible else ""
            effect = ", so that the Record of its Else begins once and never again" if records else ""
            yield Found(
                path=block.path,
                span=block.block.condition.span,
                message=f"this condition can never hold{effect}{reason}",
                hint="reverse a comparison, or write OR where one of the checks is enough",
            )


def _is_one_check(block: ResolvedBlock) -> bool:
    return sum(1 for _ in checks_in(block.block.condition)) == 1


def _impossible_signals(block: ResolvedBlock, rules: RuleModel) -> str:
    parts = block.form.parts if isinstance(block.form, Every) else (block.form,)
    names = [
        str(part.signal)
        for part in parts
        if isinstance(part, InRegion) and common(part.region, rules.context.domain(part.signal)).is_empty
    ]
    return wording.listed(names) if names else ""


@lint_rule("condition-always-holds", Severity.WARNING)
def condition_always_holds(rules: RuleModel) -> Iterator[Found]:
    """A condition holds whatever the values are.

    The block decides nothing that a default could not, and its Else has no effect.
    """
    for block in rules.blocks:
        records = bool(records_in(block.block.then))
        if rules.analysis.truths[block.order] is Truth.TRUE and (records or not _is_one_check(block)):
            effect = "its Else never applies" if block.block.otherwise else "the block never ends"
            if records:
                effect = "its Record begins once and never again"
            yield Found(
                path=block.path,
                span=block.block.condition.span,
                message=f"this condition holds for all values, so that {effect}",
                hint="write AND where all checks must hold, or make its rates the defaults",
            )


@lint_rule("and-or-mixed", Severity.WARNING)
def and_or_mixed(rules: RuleModel) -> Iterator[Found]:
    """AND and OR are mixed without parentheses.

    AND binds tighter than OR. Reading the condition from left to right gives another meaning.
    """
    for block in rules.blocks:
        for part in conditions_in(block.block.condition):
            if isinstance(part, Or):
                bare = next((operand for operand in part.operands if isinstance(operand, And)), None)
                if bare is not None:
                    yield Found(
                        path=block.path,
                        span=bare.span,
                        message="AND binds tighter than OR: this AND is one side of the OR",
                        hint="put parentheses around the part that belongs together",
                        fix=_parentheses(bare),
                    )


def _parentheses(condition: And) -> Fix | None:
    """Parentheses around the AND, which change nothing; comments inside are left to a person."""
    writer = LineWriter()
    write_condition(writer, 0, "", condition)
    text = writer.text().strip()
    if COMMENT_START in text:
        return None
    return Fix(span=condition.span, replacement=text, title="put parentheses around the AND")


@lint_rule("equals-measured", Severity.WARNING)
def equals_measured(rules: RuleModel) -> Iterator[Found]:
    """= or != compares a measured number.

    A measurement has noise and many digits: it is almost never exactly 3. Counts, states and flags
    (status.status = 2) are fine, and so are rate = 0 and bandwidth = 0.
    """
    for check in rules.checks:
        outcome = _EQUALITY_HOLDS.get(check.syntax.operator)
        if outcome is not None and _is_continuous(check, rules):
            yield Found(
                path=check.path,
                span=check.syntax.span,
                message=f"{check.signal.property} is measured: "
                f"'{check.syntax.operator.value} {check.syntax.text}' {outcome} holds",
                hint="compare with a range, a > below the number and a < above it",
            )


def _is_continuous(check: ResolvedCheck, rules: RuleModel) -> bool:
    """Whether a property is known to be measured, or the number has a fraction, as no state or count has."""
    value = check.syntax.value
    if not isinstance(value, float):
        return False
    if value == 0 and ArrivalProperty.of(check.signal) in _ZERO_WHEN_SILENT:
        return False
    return rules.context.is_measured(check.signal) or not value.is_integer()


def _times(rules: RuleModel) -> Iterator[tuple[ResolvedBlock, Timed]]:
    """Every For and Within, with its block."""
    return ((block, timed) for block in rules.blocks for timed in times_in(block.block.condition))


@lint_rule("duration-zero", Severity.WARNING)
def duration_zero(rules: RuleModel) -> Iterator[Found]:
    """A condition must hold for no time at all.

    A condition For 0 s or Within 0 s is the condition itself: noise turns the block on and off.
    """
    for block, timed in _times(rules):
        if timed.duration.ns == 0:
            yield Found(
                path=block.path,
                span=timed.duration.span,
                message=f"'{time_text(timed)}' changes nothing: the condition counts at once",
                hint=f"give a longer time, or delete the '{timed.word.value}'",
            )


@lint_rule("duration-too-short", Severity.WARNING)
def duration_too_short(rules: RuleModel) -> Iterator[Found]:
    """A duration is shorter than the time between two messages of what its condition reads.

    A condition can change with a message only, so that one message already makes it hold For the whole
    duration, or ends what it was Within. The profile's source_hz says how often messages come.
    """
    for block, timed in _times(rules):
        fastest = _fastest_source(timed, rules)
        if fastest is None or timed.duration.ns == 0:
            continue
        topic, source_hz = fastest
        if timed.duration.ns * source_hz < NS_PER_S:
            least = f"{math.ceil(NS_PER_S / NS_PER_MS / source_hz)} ms"
            yield Found(
                path=block.path,
                span=timed.duration.span,
                message=f"'{time_text(timed)}' is shorter than the {1 / source_hz:.3g} s between two "
                f"messages of {topic}: one message decides it",
                fix=Fix(span=timed.duration.span, replacement=least, title=f"write {least}"),
                hint=f"give at least {1 / source_hz:.3g} s, or delete the '{timed.word.value}'",
            )


def _fastest_source(timed: Timed, rules: RuleModel) -> tuple[str, float] | None:
    """The topic that changes the condition most often, and its Hz; ``None`` where that is not known."""
    found: tuple[str, float] | None = None
    for check in checks_in(timed):
        signal = read_check(check, rules.context.resolve, rules.context.types).signal
        source_hz = rules.context.topic(signal.topic).source_hz
        if not source_hz or ArrivalProperty.of(signal) is not None:
            return None
        if found is None or source_hz > found[1]:
            found = signal.topic, source_hz
    return found


@lint_rule("until-overlaps", Severity.WARNING)
def until_overlaps(rules: RuleModel) -> Iterator[Found]:
    """A check and its Until are true for the same value.

    An Until counts more than the check before it, so that the check does not hold where both are true.
    Mostly a comparison is the wrong way round.
    """
    for check in rules.checks:
        if check.latch is None:
            continue
        both = common(common(check.region, check.latch.off), rules.context.domain(check.signal))
        if not both.is_empty:
            yield Found(
                path=check.path,
                span=check.syntax.span,
                message=f"{check_text(check.syntax)} begins and ends at one value, for instance "
                f"{value_text(both.sample())}: there it does not hold",
                hint="let Until name a value on the other side, as in < 20 Until > 25",
            )


@lint_rule("until-never-ends", Severity.WARNING)
def until_never_ends(rules: RuleModel) -> Iterator[Found]:
    """No value that a property can have ends a check with an Until.

    Once the check was true, its block holds until the rules are exchanged.
    """
    for check in rules.checks:
        if check.latch is not None and common(check.latch.off, rules.context.domain(check.signal)).is_empty:
            yield Found(
                path=check.path,
                span=check.syntax.span,
                message=f"{check_text(check.syntax)} never ends: no value of {check.signal} ends it",
                hint="correct the number behind Until",
            )


@lint_rule("missing-blank", Severity.INFO)
def missing_blank(rules: RuleModel) -> Iterator[Found]:
    """A keyword is written without a blank after it.

    The rules work regardless, as they do with the grammar of the thesis; people and other tools may read
    the two words as one. After the name of a topic a blank is required, or the name would continue.
    """
    for path, (first, *others) in rules.glued.items():
        start = Span(first.line, first.column, first.line, first.column)
        more = f" (and {len(others)} more like it)" if others else ""
        yield Found(
            path=path,
            span=first,
            message=f"there is no blank between the previous keyword and this word{more}",
            hint="the meaning is the same; testudo fmt inserts all missing blanks",
            fix=Fix(span=start, replacement=" ", title="insert a blank here"),
        )


@lint_rule("not-analysed", Severity.INFO)
def not_analysed(rules: RuleModel) -> Iterator[Found]:
    """A condition is too complex for the checker to analyse completely.

    Finding all clashes and dead blocks is NP-hard in general, so the checker stops after a bounded
    effort. What it reports is still right; it may have missed something.
    """
    unfinished = rules.analysis.unfinished
    if unfinished:
        first = unfinished[0]
        more = f" (and {len(unfinished) - 1} more)" if len(unfinished) > 1 else ""
        yield Found(
            path=first.path,
            span=first.block.condition.span,
            message=f"{wording.block_name(first.block)}{more} is too complex to find all clashes "
            "and dead blocks",
            hint="the rules work regardless; several small blocks are easier to check",
        )
