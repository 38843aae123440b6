# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The evaluator agrees with a naive one, and a change costs what it changes."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from language.evaluator.naive_rules import TYPES, NaiveRequest, naive_blocks, naive_request, naive_signals
from language.evaluator.random_rules import block, check, keep_at_least, rule_file, rule_files, set_frequency
from smarttestudo.domain.signal import Signal, SignalKind, Truth, Values
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.language.syntax import And, Constant, Operator, Or, RateWord, RuleFile

SIGNALS = (Signal("/p", "x"), Signal("/p", "y"), Signal("/q", "x"), Signal("/q", "z"))
BORDERS = (-1.0, 0.0, 1.0, 2.0, 2.5)
TRUTHS = {False: Truth.FALSE, None: Truth.UNKNOWN, True: Truth.TRUE}

numbers = st.sampled_from([-math.inf, -1.0, -0.0, 0.0, 0.5, 1.0, 1.5, 2.0, 2.25, 2.5, 9.0, math.inf])
values = st.one_of(st.none(), st.just(math.nan), numbers)
changes = st.lists(st.dictionaries(st.sampled_from(SIGNALS), values, max_size=4), min_size=1, max_size=12)


def evaluator_of(*files: RuleFile) -> Evaluator:
    return Evaluator(compile_rules(files, lambda name: name))


def request_of(evaluator: Evaluator, topic: str) -> NaiveRequest:
    request = evaluator.decide(topic)
    return NaiveRequest(
        hz=request.planned.rate.hz,
        off=request.planned.rate.is_off and not request.planned.rate.yields_to_floor,
        reason=request.planned.reason.value,
        rule=request.planned.rule,
        place=request.block,
    )


@settings(max_examples=200)
@given(rule_files(SIGNALS, BORDERS), changes)
def test_wishes_truths_and_values_agree_with_plain_recursion_after_every_change(
    files: list[RuleFile], steps: list[dict[Signal, float | None]]
) -> None:
    evaluator = evaluator_of(*files)
    topics = compile_rules(files, lambda name: name).relayed
    known: dict[Signal, float | None] = {}
    shown = dict.fromkeys(topics)
    truths = {one.place: Truth.UNKNOWN for one in naive_blocks(files)}
    for step in [{}, *steps]:
        for signal, value in step.items():
            evaluator.set(signal, value)
            known[signal] = None if value is None or math.isnan(value) else value
        changed = evaluator.take_changed_topics()
        for topic in topics:
            expected = naive_request(files, topic, known)
            assert request_of(evaluator, topic) == expected
            assert shown[topic] == expected or topic in changed
            shown[topic] = expected
        turned = evaluator.take_changed_blocks()
        for one in naive_blocks(files):
            truth = TRUTHS[one.truth(known)]
            assert evaluator.truth(one.place) is truth
            assert truths[one.place] is truth or one.place in turned
            truths[one.place] = truth
            reads = {str(signal): known.get(signal) for signal in naive_signals(one.condition)}
            assert evaluator.values_of(one.place) == reads


WORDS = (
    "dock",
    "drive",
    "",
    True,
    False,
    *(Constant(type_name="", name=name) for name in ("ONE", "DOCK", "LOST")),
)
KINDS = (SignalKind.NUMBER, SignalKind.STATE, SignalKind.TEXT)
MANY = (Signal("/p", "x"), Signal("/p", "xs[*]"), Signal("/q", "x"), Signal("/q", "xs[*]"))
texts = st.sampled_from(["dock", "drive", "", "other", "another"])


def given_values(signal: Signal) -> st.SearchStrategy[tuple[Signal, Values | None]]:
    """Values of a signal, of its kind."""
    of_kind = texts if signal.kind is SignalKind.TEXT else numbers
    many = st.lists(of_kind, max_size=4, unique=True).map(tuple)
    return st.tuples(st.just(signal), st.none() | (many if "[*]" in signal.property else of_kind))


word_changes = st.lists(
    st.lists(
        st.one_of([given_values(signal._replace(kind=kind)) for signal in MANY for kind in KINDS]), max_size=6
    ),
    min_size=1,
    max_size=12,
)


@settings(max_examples=200)
@given(rule_files(MANY, BORDERS, words=WORDS), word_changes)
def test_truths_of_texts_states_and_elements_agree_with_plain_recursion(
    files: list[RuleFile], steps: list[list[tuple[Signal, Values | None]]]
) -> None:
    rules = compile_rules(files, lambda name: name, types=TYPES)
    evaluator = Evaluator(rules)
    known: dict[Signal, Values | None] = {}
    for step in [[], *steps]:
        for signal, value in step:
            evaluator.set(signal, value)
            known[signal] = value
        evaluator.take_changed_topics()
        for topic in rules.relayed:
            assert request_of(evaluator, topic) == naive_request(files, topic, known)
        for one in naive_blocks(files):
            assert evaluator.truth(one.place) is TRUTHS[one.truth(known)]


def modes(mode: Signal, size: int) -> Evaluator:
    """As many modes, each with a rate of its own, and one rule about all that are not the first."""
    each = [
        block(
            check(mode, Operator.EQUAL, f"mode {number}"),
            [set_frequency("/scan", 1.0 + number % 7)],
            label=f"mode {number}",
        )
        for number in range(size)
    ]
    other = block(check(mode, Operator.NOT_EQUAL, "mode 0"), [set_frequency("/imu", 3.0)], label="other")
    return evaluator_of(rule_file([set_frequency("/scan", 0.5), *each, other]))


@pytest.mark.parametrize("of_all", [False, True])
def test_another_text_looks_at_as_much_among_10000_checks_as_among_10(*, of_all: bool) -> None:
    def touched(size: int) -> int:
        mode = Signal("/mode", "data[*]" if of_all else "data", SignalKind.TEXT)
        evaluator = modes(mode, size)
        evaluator.set(mode, ("mode 3",) if of_all else "mode 3")
        evaluator.take_changed_topics()
        before = evaluator.touched
        evaluator.set(mode, ("mode 8", "mode", "modes") if of_all else "mode 8")
        assert evaluator.decide("/scan").planned.rule == "mode 8"
        evaluator.set(mode, ("something else",) if of_all else "something else")
        assert evaluator.decide("/scan").planned.rule is None
        return evaluator.touched - before

    assert touched(10_000) <= touched(10) <= 10


def zone(column: float, row: float) -> And:
    x, y = Signal("/odom", "pose_x"), Signal("/odom", "pose_y")
    return And(
        operands=(
            check(x, Operator.GREATER, column),
            check(x, Operator.LESS, column + 1),
            check(y, Operator.GREATER, row),
            check(y, Operator.LESS, row + 1),
        ),
        span=check(x, Operator.LESS, 0).span,
    )


def zones(columns: int, rows: int, *, otherwise: bool = False) -> Evaluator:
    """A grid of zones, each of which sets /scan and, with ``otherwise``, sets /imu outside of itself."""
    statements = [
        block(
            zone(column, row),
            [set_frequency("/scan", 1.0 + (column + row) % 7)],
            [set_frequency("/imu", 3.0)] if otherwise else [],
            label=f"zone {column} {row}",
        )
        for column in range(columns)
        for row in range(rows)
    ]
    return evaluator_of(rule_file([set_frequency("/scan", 0.5), *statements]))


def touched_by_crossing(evaluator: Evaluator, border: float, row: float) -> int:
    """How much the evaluator looks at when the robot crosses a border between two columns."""
    evaluator.set(Signal("/odom", "pose_y"), row + 0.5)
    evaluator.set(Signal("/odom", "pose_x"), border - 0.25)
    evaluator.take_changed_topics()
    before = evaluator.touched
    evaluator.set(Signal("/odom", "pose_x"), border)
    evaluator.set(Signal("/odom", "pose_x"), border + 0.25)
    assert evaluator.take_changed_topics()
    assert evaluator.decide("/scan").planned.rule == f"zone {int(border)} {int(row)}"
    return evaluator.touched - before


@pytest.mark.full
@pytest.mark.parametrize("otherwise", [False, True])
def test_crossing_a_border_looks_at_as_much_among_2500_zones_as_among_4(otherwise: bool) -> None:
    few = touched_by_crossing(zones(2, 2, otherwise=otherwise), border=1, row=1)
    many = touched_by_crossing(zones(50, 50, otherwise=otherwise), border=20, row=30)
    assert many <= few


def test_a_value_that_crosses_nothing_looks_at_nothing() -> None:
    evaluator = zones(10, 10)
    evaluator.set(Signal("/odom", "pose_x"), 3.25)
    evaluator.set(Signal("/odom", "pose_y"), 3.25)
    evaluator.take_changed_topics()
    before = evaluator.touched
    evaluator.set(Signal("/odom", "pose_x"), 3.75)
    assert evaluator.touched == before
    assert not evaluator.take_changed_topics()


def test_a_common_check_looks_at_the_live_partners_among_many_topics_only() -> None:
    common = check(Signal("/mode", "data"), Operator.GREATER, 0)

    def fleet(size: int) -> int:
        evaluator = evaluator_of(
            rule_file(
                [
                    block(
                        And(
                            operands=(
                                common,
                                check(Signal(f"/robot_{robot}/battery", "level"), Operator.LESS, 20),
                            ),
                            span=common.span,
                        ),
                        [set_frequency("/scan", 1.0)],
                        label=f"robot {robot}",
                    )
                    for robot in range(size)
                ]
            )
        )
        for robot in range(size):
            evaluator.set(Signal(f"/robot_{robot}/battery", "level"), 10.0 if robot == 1 else 90.0)
        evaluator.set(Signal("/mode", "data"), 0.0)
        evaluator.take_changed_topics()
        before = evaluator.touched
        evaluator.set(Signal("/mode", "data"), 1.0)
        assert evaluator.decide("/scan").planned.rule == "robot 1"
        return evaluator.touched - before

    assert fleet(1000) <= fleet(5)


def test_a_block_and_its_else_are_one_condition_so_that_one_of_them_holds() -> None:
    evaluator = zones(3, 3, otherwise=True)
    evaluator.set(Signal("/odom", "pose_x"), 1.5)
    evaluator.set(Signal("/odom", "pose_y"), 7.5)
    assert {evaluator.truth(order) for order in range(0, 18, 2)} == {Truth.FALSE}
    assert {evaluator.truth(order) for order in range(1, 18, 2)} == {Truth.TRUE}


def test_a_written_off_stays_off_and_a_plain_zero_yields_to_the_floor() -> None:
    floors = [keep_at_least(name, 2.0) for name in ("/off", "/zero")]
    evaluator = evaluator_of(
        rule_file([set_frequency("/off", RateWord.OFF), set_frequency("/zero", 0.0), *floors])
    )
    assert str(evaluator.request("/off").rate) == "Off"
    assert str(evaluator.request("/zero").rate) == "2 Hz"
    assert evaluator.request("/zero").reason.value == "floor"


@pytest.mark.full
def test_a_condition_with_thousands_of_checks_of_one_signal_compiles() -> None:
    signal = Signal("/p", "x")
    apart = [check(signal, Operator.NOT_EQUAL, float(number)) for number in range(3000)]
    condition = And(operands=tuple(apart), span=apart[0].span)
    either = Or(
        operands=tuple(check(signal, Operator.EQUAL, float(number)) for number in range(3000)),
        span=apart[0].span,
    )
    evaluator = evaluator_of(
        rule_file([block(condition, [set_frequency("/a", 1.0)]), block(either, [set_frequency("/a", 2.0)])])
    )
    evaluator.set(signal, 17.0)
    assert (evaluator.truth(0), evaluator.truth(1)) == (Truth.FALSE, Truth.TRUE)
    evaluator.set(signal, 17.5)
    assert (evaluator.truth(0), evaluator.truth(1)) == (Truth.TRUE, Truth.FALSE)
