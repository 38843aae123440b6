# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How fast OBI is, against the thesis's way (PuLP with CBC, one solve a block) in the same run.

Run it with ``python benchmarks/optimizer_speed.py [--topics 1000] [--blocks 1000]``.
"""

from __future__ import annotations

import argparse
import random
import resource
import statistics
import warnings
from collections.abc import Callable

from smarttestudo.domain.finding import Span
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.rate import Tier
from smarttestudo.optimizer.model import Model, Requirement, needs_of
from smarttestudo.optimizer.requirements import RuleRequirements, Subproblem
from smarttestudo.optimizer.rule_rates import solve_requirements
from smarttestudo.optimizer.run_time import TopicRequest, plan_within

TOPICS_A_BLOCK = 10
SCARCE_SHARE = 0.6
AIM_S = 0.05
RUN_TIME_TOPICS = 50
REPLANS = 500
PULP_BLOCKS = 50
"""How many blocks PuLP solves at most; the time of all is that of these, scaled."""

_HERE = Span(line=1, column=1, end_line=1, end_column=2)


def profile_of(count: int, generator: random.Random) -> Profile:
    """Topics of 50 B to 5 MB with random tiers."""
    topics = {}
    for index in range(count):
        tiers = tuple(sorted(round(generator.uniform(0.5, 100), 1) for _ in Tier))
        size_kb = round(0.05 * 100_000 ** generator.random(), 3)
        topics[f"/topic_{index}"] = TopicProfile(message_kb=size_kb, tiers_hz=tiers)
    return Profile(topics=topics)


def requirements_of(profile: Profile, count: int, generator: random.Random) -> RuleRequirements:
    """Every topic Unacceptable by default, and blocks that ask more of ten each."""
    needs = {topic: needs_of(topic, profile) for topic in profile.topics}
    defaults = {topic: Requirement(needs=needs[topic], wanted=Tier.UNACCEPTABLE) for topic in needs}
    blocks = [
        {
            topic: Requirement(needs=needs[topic], wanted=generator.choice(list(Tier)))
            for topic in generator.sample(list(needs), TOPICS_A_BLOCK)
        }
        for _ in range(count)
    ]
    return RuleRequirements(
        defaults=_subproblem(None, defaults),
        blocks=tuple(
            _subproblem(f"block {index}", requirements) for index, requirements in enumerate(blocks)
        ),
        appended=(),
    )


def _subproblem(label: str | None, requirements: dict[str, Requirement]) -> Subproblem:
    return Subproblem(
        label=label, path="benchmark.adirf", span=_HERE, requirements=requirements, tier_statements=()
    )


def pulp_seconds(requirements: RuleRequirements, budget_kb_per_s: float) -> float | None:
    """Seconds of CPU for one PuLP solve a block; ``None`` where PuLP is not installed."""
    try:
        import pulp  # noqa: PLC0415  a benchmark's guest
    except ModuleNotFoundError:
        return None
    warnings.simplefilter("ignore", DeprecationWarning)
    solver = pulp.PULP_CBC_CMD(msg=False)
    started = cpu_s()
    solved = requirements.blocks[:PULP_BLOCKS]
    for block in solved:
        problem = pulp.LpProblem("block", pulp.LpMaximize)
        bounds = {
            topic: requirement.bounds_hz(Model.QUPER) for topic, requirement in block.requirements.items()
        }
        rates = {
            topic: pulp.LpVariable(f"f{index}", *bounds[topic])
            for index, topic in enumerate(block.requirements)
        }
        problem += pulp.lpSum(rates.values())
        problem += (
            pulp.lpSum(
                requirement.needs.size_kb * rates[topic] for topic, requirement in block.requirements.items()
            )
            <= budget_kb_per_s
        )
        problem.solve(solver)
    return (cpu_s() - started) * len(requirements.blocks) / len(solved)


def cpu_s() -> float:
    """The CPU time of this process and of those that it started, so far."""
    spent = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in spent)


def median_s(run: Callable[[], object], *, number: int, repeats: int = 5) -> float:
    """The median over repeats of the mean CPU time of one call."""
    times = []
    for _ in range(repeats):
        started = cpu_s()
        for _ in range(number):
            run()
        times.append((cpu_s() - started) / number)
    return statistics.median(times)


def main() -> None:
    """Print the times and the ratio."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--topics", type=int, default=1000)
    parser.add_argument("--blocks", type=int, default=1000)
    arguments = parser.parse_args()
    generator = random.Random(1)
    profile = profile_of(arguments.topics, generator)
    requirements = requirements_of(profile, arguments.blocks, generator)
    budget = 2 * sum((one.message_kb or 0) * (one.tiers_hz or (0,))[0] for one in profile.topics.values())

    def solve(share: float) -> Callable[[], object]:
        return lambda: solve_requirements(requirements, share * budget, model=Model.QUPER)

    ours, scarce = median_s(solve(1.0), number=1), median_s(solve(SCARCE_SHARE), number=1)
    theirs = pulp_seconds(requirements, budget)
    print(
        f"{arguments.topics} topics, {arguments.blocks} blocks of {TOPICS_A_BLOCK}: {ours:.3f} s of CPU, "
        f"{scarce:.3f} s where not all fits (aim: at most {AIM_S:g} s)"
    )
    if theirs is None:
        print("PuLP is not installed: no ratio")
    else:
        print(f"PuLP, one solve a block: {theirs:.1f} s (at most {PULP_BLOCKS} solved, scaled)")
        print(f"PuLP takes {theirs / ours:.0f} times as long")
    loads = [
        TopicRequest(
            topic=f"/topic_{index}",
            requested_hz=generator.uniform(1, 50),
            floor_hz=generator.choice((0.0, 1.0)),
            priority=generator.choice((1.0, 2.0, 5.0)),
            size_kb=generator.uniform(0.05, 100),
            source_hz=60.0,
        )
        for index in range(RUN_TIME_TOPICS)
    ]
    half = sum(load.size_kb * load.wanted_hz for load in loads) / 2
    replan = median_s(lambda: plan_within(loads, half), number=REPLANS)
    print(f"re-plan of {RUN_TIME_TOPICS} topics: {1e6 * replan:.0f} µs", end="")
    a_solve = None if theirs is None else theirs / arguments.blocks
    print("" if a_solve is None else f", one PuLP solve takes {a_solve / replan:.0f} times as long")


if __name__ == "__main__":
    main()
