# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What was measured as Markdown: of several runs the median, and the least and the greatest in brackets."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import median

from thin_link.cases import Case, Seen, Target, quantile
from thin_link.traffic import Topic

_SHARES = (0.5, 0.95, 1.0)
Runs = Mapping[str, Sequence[Seen]]
"""What each contender brought in each run."""


def print_rates(seen: Mapping[Case, Runs], names: Mapping[str, str]) -> None:
    """How often each topic came, and which share of the link that took."""
    print(
        "\n| link and traffic | rate at the operator of | offered Hz |",
        *(f"{one}: Hz |" for one in names.values()),
    )
    print("| --- | --- |" + " ---: |" * (1 + len(names)))
    for case, runs in seen.items():
        for number, topic in enumerate(case.topics):
            rates = (spread([one.rate_hz(topic) for one in runs.get(each, ())], ".2f") for each in names)
            print(_row([case.title if not number else "", f"`{topic.name}`", f"{topic.hz:.3g}", *rates]))
        used = (spread([one.used for one in runs.get(each, ())], ".0%") for each in names)
        print(_row(["", "share of the link used", "", *used]))


def print_ages(seen: Mapping[Case, Runs], names: Mapping[str, str]) -> None:
    """How old messages were when they arrived: median, 95th percentile and maximum."""
    print(
        "\n| link and traffic | age at the operator of |",
        *(f"{one}: p50, p95, max in s |" for one in names.values()),
    )
    print("| --- | --- |" + " ---: |" * len(names))
    for case, runs in seen.items():
        for number, topic in enumerate(case.topics):
            ages = (_ages(runs.get(each, ()), topic) for each in names)
            print(_row([case.title if not number else "", f"`{topic.name}`", *ages]))


def _ages(runs: Sequence[Seen], topic: Topic) -> str:
    ages_s = [ages for one in runs if (ages := one.ages_s([topic]))]
    if not ages_s:
        return "–"
    return ", ".join(spread([quantile(ages, share) for ages in ages_s], ".3f") for share in _SHARES)


def print_targets(seen: Mapping[Case, Runs], names: Mapping[str, str]) -> None:
    """Each target, and what each contender made of it."""
    print("\n| case | target |", *(f"{one} |" for one in names.values()))
    print("| --- | --- |" + " --- |" * len(names))
    for case, runs in seen.items():
        judged = {contender: [case.judge(one) for one in runs.get(contender, ())] for contender in names}
        count = max((len(targets) for each in judged.values() for targets in each), default=0)
        for number in range(count):
            found = {contender: [targets[number] for targets in each] for contender, each in judged.items()}
            first = next(each[0] for each in found.values() if each)
            cells = [case.title if not number else "", first.wanted]
            print(_row([*cells, *(_judged(each) for each in found.values())]))
        costs = (spread([one.cpu_s_per_mb for one in runs.get(each, ())], ".3f") for each in names)
        print(_row(["", "s of CPU for a MB sent", *costs]))


def print_limits(limits: Mapping[str, Sequence[Sequence[Target]]]) -> None:
    """What SmartTestudo's ends took."""
    print("\n| case | target | SmartTestudo |\n| --- | --- | --- |")
    for title, runs in limits.items():
        for number, targets in enumerate(zip(*runs, strict=True)):
            print(_row([title if not number else "", targets[0].wanted, _judged(targets)]))


def _judged(targets: Sequence[Target]) -> str:
    if not targets:
        return "–"
    missed = "" if all(one.is_met for one in targets) else ", **missed**"
    return spread([one.value for one in targets], ".3g") + missed


def spread(values: Sequence[float], form: str) -> str:
    """The median, and of several the least and the greatest."""
    if not values:
        return "–"
    middle, least, most = (_shown(value, form) for value in (median(values), min(values), max(values)))
    return middle if least == most else f"{middle} ({least} to {most})"


def _shown(value: float, form: str) -> str:
    """``value``, or that there was nothing to measure it by; large ones without an exponent."""
    if not math.isfinite(value):
        return "none"
    return f"{value:.0f}" if value >= 1_000 else f"{value:{form}}"


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
