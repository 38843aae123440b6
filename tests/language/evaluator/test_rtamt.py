# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``For`` and ``Within`` mean what RTAMT's ``historically`` and ``once`` mean.

RTAMT (D. Nickovic and T. Yamaguchi, "RTAMT: Online robustness monitors from STL", ATVA 2020) monitors signal
temporal logic; where its robustness is above zero, a formula holds.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from random import Random

import pytest

from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.evaluator import Evaluator
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules

SIGNALS = 200
LENGTH_S = 60
DEPTH = 3
JUMP = 0.4


@dataclass(frozen=True, slots=True, kw_only=True)
class Formula:
    """One formula in both languages, known once ``reach_s`` have passed."""

    rule: str
    stl: str
    reach_s: int


def random_formula(random: Random, depth: int) -> Formula:
    kind = random.choice(["For", "Within", "For", "Within", "AND", "OR", "Not"]) if depth else "check"
    if kind == "check":
        # No value lies on a border, where the robustness would be zero.
        comparison = f"{random.choice(['>', '<'])} {random.randint(0, 9) + 0.5}"
        return Formula(rule=f"CheckValue /a x {comparison}", stl=f"(x {comparison})", reach_s=0)
    first = random_formula(random, depth - 1)
    match kind:
        case "For" | "Within":
            length_s = random.randint(0, 6)
            word = "historically" if kind == "For" else "once"
            return Formula(
                rule=f"(({first.rule}) {kind} {length_s} s)",
                stl=f"({word}[0:{length_s}]({first.stl}))",
                reach_s=first.reach_s + length_s,
            )
        case "Not":
            return Formula(rule=f"(Not ({first.rule}))", stl=f"(not ({first.stl}))", reach_s=first.reach_s)
    second = random_formula(random, depth - 1)
    return Formula(
        rule=f"(({first.rule}) {kind} ({second.rule}))",
        stl=f"({first.stl} {kind.lower()} {second.stl})",
        reach_s=max(first.reach_s, second.reach_s),
    )


def random_signal(random: Random) -> list[float]:
    """A level that stays for a while and then is another one."""
    values = [float(random.randint(0, 10))]
    while len(values) < LENGTH_S:
        values.append(float(random.randint(0, 10)) if random.random() < JUMP else values[-1])
    return values


def truths(rule: str, values: list[float]) -> list[Truth]:
    parsed = parse(f"begin If ({rule}) Then SetFrequency /b 1 end", "rules.adirf")
    assert not [finding for finding in parsed.findings if finding.severity.value == "error"]
    evaluator = Evaluator(compile_rules([parsed.file], lambda name: name))
    found = []
    for second, value in enumerate(values):
        evaluator.advance(second * NS_PER_S)
        evaluator.set(Signal("/a", "x"), value)
        found.append(evaluator.truth(0))
    return found


@pytest.mark.full
@pytest.mark.parametrize("seed", range(SIGNALS))
def test_a_condition_with_time_holds_when_rtamt_says_that_it_does(seed: int) -> None:
    with warnings.catch_warnings():
        # Its parser's package names what Python 3.12 no longer has.
        warnings.simplefilter("ignore", DeprecationWarning)
        rtamt = pytest.importorskip("rtamt")

    random = Random(seed)
    formula, values = random_formula(random, DEPTH), random_signal(random)
    monitor = rtamt.StlDiscreteTimeSpecification()
    monitor.declare_var("x", "float")
    monitor.declare_var("holds", "float")
    monitor.spec = f"holds = {formula.stl}"
    monitor.parse()
    robustness = monitor.evaluate({"time": [*range(LENGTH_S)], "x": values})
    known = slice(formula.reach_s, None)
    expected = [Truth.TRUE if margin > 0 else Truth.FALSE for _, margin in robustness]
    assert truths(formula.rule, values)[known] == expected[known], formula
