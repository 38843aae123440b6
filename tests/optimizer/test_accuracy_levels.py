# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Quality levels of accuracy: OBI chooses bounds by the rates that they were measured to need."""

from __future__ import annotations

import itertools
import json
import math
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from optimizer.instances import accuracy_tiers
from smarttestudo.cli.main import main
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import LevelledProperty, Profile, TopicProfile
from smarttestudo.domain.rate import Tier
from smarttestudo.language.parser import parse
from smarttestudo.optimizer.model import Model
from smarttestudo.optimizer.requirements import TopicsWithoutDefault
from smarttestudo.optimizer.rule_rates import Optimization, optimize_rules

PROFILE = """\
budget_kb_per_s = {budget}
[topics."/odom"]
type = "nav_msgs/msg/Odometry"
message_kb = 1
source_hz = 25
tiers_hz = [1, 2, 5, 10, 20, 25]
tiers_m = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]
tiers_m_need_hz = [1, 2, 4, 8, 16, 24]
{extra}
"""
RULES = """\
begin
    SetFrequency /odom Full
    KeepWithin /odom position {level}  // as seen from afar
{more}end
"""


def run(
    tmp_path: Path,
    *arguments: str,
    level: str = "Acceptable",
    more: str = "",
    budget: float = 10,
    extra: str = "",
    rules_text: str = RULES,
) -> int:
    """A command on the two files, which come first."""
    rules, profile = tmp_path / "rules.adirf", tmp_path / "profile.toml"
    rules.write_text(rules_text.format(level=level, more=more), encoding="utf-8")
    profile.write_text(PROFILE.format(budget=budget, extra=extra), encoding="utf-8")
    command, *options = arguments
    return main([command, str(rules), "--profile", str(profile), *options])


@pytest.mark.parametrize(
    ("level", "budget", "bound"),
    [
        ("Acceptable", 10, "0.1"),
        ("Acceptable", 3, "0.15"),
        ("Acceptable", 2, "0.2"),
        ("Unacceptable", 10, "0.5"),
        ("Excessive", 30, "0.01"),
        ("Competitive", 9, "0.04625"),
    ],
)
def test_a_level_becomes_the_tightest_bound_of_its_accuracies_that_fits(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], level: str, budget: float, bound: str
) -> None:
    assert run(tmp_path, "optimize", level=level, budget=budget) == 0
    _, *lines = capsys.readouterr().out.splitlines()
    assert lines == RULES.format(level=bound, more="").splitlines()


def test_a_level_alone_gets_no_default_that_would_limit_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules = RULES.replace("    SetFrequency /odom Full\n", "")
    assert run(tmp_path, "optimize", rules_text=rules) == 0
    _, *lines = capsys.readouterr().out.splitlines()
    assert lines == rules.format(level="0.1", more="").splitlines()


IN_A_BLOCK = (
    "    If CheckValue /odom pose_x > 3 Then\n        KeepWithin /odom position Competitive\n    EndIf\n"
)
NO_BOUND = RULES.replace("    KeepWithin /odom position {level}  // as seen from afar\n", "")


def test_a_bound_in_a_block_gets_no_default_that_would_limit_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules = NO_BOUND.replace("    SetFrequency /odom Full\n", "")
    assert run(tmp_path, "optimize", rules_text=rules, more=IN_A_BLOCK, budget=30) == 0
    _, *lines = capsys.readouterr().out.splitlines()
    assert lines == rules.format(more=IN_A_BLOCK.replace("Competitive", "0.02")).splitlines()


@pytest.mark.parametrize(
    ("model", "level", "budget"),
    [("quper", "Desirable", 7), ("maxmin", "Desirable", 7), ("budget", "Marginal", 20)],
)
def test_the_rate_that_a_default_got_is_the_ceiling_of_a_bound_in_a_block(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], model: str, level: str, budget: float
) -> None:
    rules = NO_BOUND.replace("Full", level)
    options = ["--model", model, "--json"]
    assert run(tmp_path, "optimize", *options, rules_text=rules, more=IN_A_BLOCK, budget=budget) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["defaults"] == {"/odom": budget}
    (block,) = answer["blocks"]
    assert block["used_kb_per_s"] == budget


def test_a_level_that_does_not_fit_is_refused_with_the_level_that_does(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, "optimize", level="Competitive", budget=5) == 1
    assert (
        capsys.readouterr()
        .err.splitlines()[0]
        .endswith(
            "error[infeasible]: the defaults need at least 8 KB/s, 3 more than the budget of 5: "
            "/odom position Competitive takes 8"
        )
    )


def test_a_ceiling_costs_no_more_than_its_rate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    more = "    If CheckValue /odom pose_x > 3 Then\n        SetFrequency /odom 3\n    EndIf\n"
    assert run(tmp_path, "optimize", "--json", level="Acceptable", more=more) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["defaults_part"]["bounds"] == {"/odom position": 0.1}
    assert answer["defaults_part"]["used_kb_per_s"] == 4
    (block,) = answer["blocks"]
    assert block["used_kb_per_s"] == 3


def test_a_level_as_the_ceiling_of_a_bound_topic_is_the_upper_end_of_the_level(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = "    If CheckValue /odom pose_x > 3 Then\n        SetFrequency /odom Desirable\n    EndIf\n"
    assert run(tmp_path, "optimize", level="Acceptable", more=more, budget=5) == 0
    assert "SetFrequency /odom 10\n" in capsys.readouterr().out


def test_a_topic_with_a_bound_of_unknown_need_counts_by_its_rate(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = "    KeepWithin /odom orientation Desirable\n"
    extra = "tiers_deg = [20, 10, 5, 3, 2, 1]"
    assert run(tmp_path, "optimize", more=more, budget=30, extra=extra) == 0
    printed = capsys.readouterr().out
    assert "KeepWithin /odom position 0.1 " in printed
    assert "KeepWithin /odom orientation 3\n" in printed
    assert run(tmp_path, "optimize", more=more, budget=24, extra=extra) == 1
    assert "the defaults need at least 25 KB/s" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "complaint"),
    [
        (
            "    KeepWithin /odom orientation Marginal\n",
            '[topics."/odom"] has no tiers_deg; add tiers_deg, six accuracies α0 … α5 of orientation in deg',
        ),
        (
            "    KeepWithin /odom pose_x Marginal\n",
            "pose_x of /odom has no quality levels, only position, orientation, positions have; "
            "write a number in the rules",
        ),
    ],
)
def test_a_level_that_the_profile_lacks_is_named_by_check_and_optimize(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: str, complaint: str
) -> None:
    cause, _, _ = complaint.partition(";")
    assert run(tmp_path, "check", more=more) == 1
    assert f"error[profile-incomplete]: {cause}" in capsys.readouterr().out
    assert run(tmp_path, "optimize", more=more) == 1
    assert capsys.readouterr().err == f"{tmp_path / 'profile.toml'}: error: {complaint}\n"


def test_the_worst_situation_counts_what_bounds_need(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = "    If CheckValue /odom pose_x > 3 Then\n        KeepWithin /odom position 0.02\n    EndIf\n"
    assert run(tmp_path, "check", more=more, budget=20) == 0
    assert "the topics take at most 16 of 20 KB/s" in capsys.readouterr().out
    assert run(tmp_path, "check", level="0.1", more=more, budget=15) == 0
    printed = capsys.readouterr().out
    assert (
        'where "block at line 4" (line 4) holds, as at /odom pose_x = 4, the topics take 16 KB/s' in printed
    )


_levels = st.sampled_from([Tier.MARGINAL, Tier.ACCEPTABLE, Tier.DESIRABLE, Tier.COMPETITIVE, *Tier])


@cache
@st.composite
def bound_topics(draw: st.DrawFn) -> TopicProfile:
    """A topic with measured accuracies of its position."""
    return TopicProfile(
        message_kb=draw(st.sampled_from([0.1, 1.0, 420.0]) | st.floats(0.01, 1000)),
        source_hz=200.0,
        accuracies={LevelledProperty.POSITION: draw(accuracy_tiers())},
    )


def optimized(
    topics: list[TopicProfile], wanted: list[Tier], budget: float
) -> tuple[Optimization, list[float]]:
    """What OBI makes of one KeepWithin for each topic, and the bounds in their order."""
    lines = [
        f"SetFrequency /t{n} Full KeepWithin /t{n} position {tier.value}" for n, tier in enumerate(wanted)
    ]
    file = parse("begin\n" + "\n".join(lines) + "\nend", "rules.adirf").file
    profile = Profile(budget_kb_per_s=budget, topics={f"/t{n}": topic for n, topic in enumerate(topics)})
    done = optimize_rules(
        [file],
        profile,
        resolve_topic,
        model=Model.QUPER,
        without_default=TopicsWithoutDefault.LEFT_OUT,
    )
    return done, [
        done.tier_bounds[key] for key, _ in done.defaults.subproblem.tier_statements if done.feasible
    ]


def greatest_sum_hz(ends: list[tuple[float, float, float]], budget: float) -> float | None:
    """Of (KB, lowest, highest Hz), by trying every corner: all but one at an end, that one as it fits."""
    best = None
    for corner in itertools.product((1, 2), repeat=len(ends)):
        for between, (kb, low_hz, high_hz) in enumerate(ends):
            rates = [one[end] for one, end in zip(ends, corner, strict=True)]
            rates[between] = 0.0
            used = math.fsum(one[0] * hz for one, hz in zip(ends, rates, strict=True))
            if used + kb * low_hz > budget + 1e-9 * max(1.0, budget):
                continue
            rates[between] = max(low_hz, min(high_hz, (budget - used) / kb))
            best = sum(rates) if best is None else max(best, sum(rates))
    return best


@given(data=st.data(), share=st.sampled_from([0.0, 0.5, 1.0]) | st.floats(-0.2, 1.2))
@settings(max_examples=300)
def test_obi_chooses_the_accuracies_that_a_search_of_all_corners_finds(
    data: st.DataObject, share: float
) -> None:
    topics = data.draw(st.lists(bound_topics(), min_size=1, max_size=4))
    wanted = [data.draw(_levels) for _ in topics]
    ends = []
    for topic, tier in zip(topics, wanted, strict=True):
        tiers = topic.accuracies[LevelledProperty.POSITION]
        levels = list(Tier).index(tier)
        first = levels if tier in {Tier.UNACCEPTABLE, Tier.EXCESSIVE} else levels - 1
        assert tiers.needs_hz is not None
        assert topic.message_kb is not None
        ends.append((topic.message_kb, tiers.needs_hz[first], tiers.needs_hz[levels]))
    least = math.fsum(kb * low for kb, low, _ in ends)
    most = math.fsum(kb * high for kb, _, high in ends)
    budget = max(0.0, least + share * (most - least))
    done, bounds = optimized(topics, wanted, budget)
    best = greatest_sum_hz(ends, budget)
    assert done.feasible == (best is not None)
    if best is None or done.defaults.rates_hz is None:
        return
    # Each rate is rounded down to 0.001 Hz.
    assert (
        best - 0.001 * len(topics) - 1e-6 * best <= sum(done.defaults.rates_hz.values()) <= best * (1 + 1e-9)
    )
    for topic, tier, bound, rate_hz in zip(
        topics, wanted, bounds, done.defaults.rates_hz.values(), strict=True
    ):
        tiers = topic.accuracies[LevelledProperty.POSITION]
        loosest, tightest = tiers.interval(tier)
        assert tightest <= bound <= loosest
        assert tiers.needed_hz(bound) <= rate_hz * (1 + 1e-9) + 1e-9 or bound == loosest
        # A bound is rounded up to four digits, and no tighter one of so many digits would do.
        assert bound == tightest or tiers.needed_hz(bound * 0.998) >= rate_hz * (1 - 1e-9)
