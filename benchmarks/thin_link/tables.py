# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What was measured as Markdown: of several runs the median, and the least and the greatest in brackets."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from statistics import median

from thin_link.cases import Case, Seen, Target, quantile
from thin_link.roles import Topic

_SHARES = (0.5, 0.95, 1.0)
Runs = Mapping[str, Sequence[Seen]]
"""What each contender brought in each run."""


def print_arrivals(seen: Mapping[Case, Runs], names: Mapping[str, str]) -> None:
    """The rate and the ages of each topic."""
    print(
        "\n| link and traffic | topic, offered Hz |",
        *(f"{one}: Hz | age in s: p50, p95, max |" for one in names.values()),
    )
    print("| --- | --- |" + " ---: |" * 2 * len(names))
    for case, runs in seen.items():
        for number, topic in enumerate(case.topics):
            cells = [case.title if not number else "", f"`{topic.name}` {topic.hz:.3g}"]
            for contender in names:
                cells += _topic_cells(runs.get(contender, ()), topic)
            print(_row(cells))


def _topic_cells(runs: Sequence[Seen], topic: Topic) -> list[str]:
    rates_hz = [one.rate_hz(topic) for one in runs]
    ages_s = [ages for one in runs if (ages := one.ages_s([topic]))]
    if not ages_s:
        return ["0", "–"]
    spreads = (_spread([quantile(ages, share) for ages in ages_s], ".3f") for share in _SHARES)
    return [_spread(rates_hz, ".2f"), ", ".join(spreads)]


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
        for name, costs in _costs(runs, names).items():
            print(_row(["", name, *costs]))


def _costs(runs: Runs, names: Mapping[str, str]) -> Mapping[str, list[str]]:
    """What no target is about."""
    return {
        "share of the link used": [
            _spread([one.used for one in runs.get(each, ())], ".0%") for each in names
        ],
        "s of CPU for a MB sent": [
            _spread([one.cpu_s_per_mb for one in runs.get(each, ())], ".3f") for each in names
        ],
    }


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
    return _spread([one.value for one in targets], ".3g") + missed


def _spread(values: Sequence[float], form: str) -> str:
    if not values:
        return "–"
    middle, least, most = (_shown(value, form) for value in (median(values), min(values), max(values)))
    return middle if len(values) == 1 else f"{middle} ({least} to {most})"


def _shown(value: float, form: str) -> str:
    """``value``, or that there was nothing to measure it by."""
    return f"{value:{form}}" if math.isfinite(value) else "none"


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"
