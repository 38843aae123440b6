# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Functions for scripts and notebooks, as in ``from smarttestudo import replay``.

Whatever goes wrong is a ``TestudoError`` with place, cause and remedy.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from os import PathLike
from pathlib import Path
from typing import Protocol, runtime_checkable

from smarttestudo.accuracy import recorded_loss as loss
from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.bags import measure
from smarttestudo.bags.bag_summary import BagSummary
from smarttestudo.bags.reader import open_recording
from smarttestudo.checks import CheckContext
from smarttestudo.domain.budget import budget_kb_per_s as budget_kb_per_s_of
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.finding import Finding
from smarttestudo.domain.profile import Profile
from smarttestudo.files.outputs import require_separate
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop import decision_log
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.replays import replay as replaying
from smarttestudo.replays.outcome import ReplayOutcome
from smarttestudo.rules.findings import all_findings
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_files import find_rule_files, read_rule_text
from smarttestudo.rules.rule_sets import load_rules

AnyPath = str | PathLike[str]


@runtime_checkable
class Tabular(Protocol):
    """A result that is a table."""

    def rows(self) -> Iterable[Mapping[str, object]]:
        """Its rows, by column."""


class Record(Protocol):
    """A result that is one row of a table."""

    def to_json(self) -> dict[str, object]:
        """The row, by column."""


def check_rules(*rules: AnyPath, profile: AnyPath | None = None) -> tuple[Finding, ...]:
    """Check ``rules``, files or folders of them that form one set: return what is wrong or doubtful.

    With a ``profile`` (TOML) also what breaks its budget. Raises ``TestudoError`` for what cannot be read.
    """
    context = CheckContext(profile=None if profile is None else load_profile(Path(profile)))
    files = find_rule_files(map(Path, rules))
    return tuple(all_findings([parse(read_rule_text(file), str(file)) for file in files], context))


def read_rules(*rules: AnyPath, profile: AnyPath | None = None) -> RuleSet:
    """The rule set that the rule files, or folders of them, ``rules`` are together.

    Quality levels need a ``profile`` (TOML). Raises ``TestudoError`` for what cannot be read, and with the
    first error where there is one.
    """
    loaded = load_rules([*map(Path, rules)], profile=None if profile is None else load_profile(Path(profile)))
    loaded.refuse_errors()
    return loaded.rule_set


def replay(
    bag: AnyPath,
    rules: RuleSet,
    output: AnyPath,
    *,
    profile: AnyPath | None = None,
    budget_kb_per_s: float | None = None,
    repeat_slow: bool = False,
    decisions: AnyPath | None = None,
) -> ReplayOutcome:
    """Write into the new folder ``output`` what an operator would have received of ``bag`` under ``rules``.

    A source below its target is repeated where ``repeat_slow``, else passed as it comes. ``decisions`` names
    a file for the decisions (JSON Lines). Raises ``TestudoError`` for what cannot be read or written.
    """
    _require_rules(rules)
    budget = None if budget_kb_per_s is None else _budget(budget_kb_per_s)
    log = None if decisions is None else Path(decisions)
    inputs = (Path(bag), None if profile is None else Path(profile))
    require_separate({"output": Path(output), "decisions": log}, inputs)
    with ExitStack() as opened:
        request = replaying.ReplayRequest(
            recording=opened.enter_context(open_recording(Path(bag))),
            rule_set=rules,
            output=Path(output),
            profile=Profile() if profile is None else load_profile(Path(profile)),
            when_slow=WhenSlow.REPEAT if repeat_slow else WhenSlow.PASS,
            budget_kb_per_s=budget,
            decided=_ignore if log is None else opened.enter_context(decision_log.decision_log(log)),
        )
        return replaying.replay(request)


def measure_bag(bag: AnyPath, *, latency: bool = False) -> BagSummary:
    """How fast each topic of ``bag`` came and how much it carried, and how late with ``latency``.

    Raises ``TestudoError`` where it cannot be read.
    """
    return measure.measure_bag(Path(bag), _ignore, with_latency=latency)


def measure_loss(
    sent: AnyPath,
    received: AnyPath,
    *,
    rules: RuleSet | None = None,
    profile: AnyPath | None = None,
    topics: Sequence[str] = (),
) -> LossReport:
    """Measure what the operator lost between the recordings ``sent`` by the robot and ``received``.

    ``rules`` give the thresholds whose crossings count, ``topics`` are names or patterns, empty for all.
    Raises ``TestudoError`` where one cannot be read, or they share nothing.
    """
    if rules is not None:
        _require_rules(rules)
    question = loss.LossQuestion(
        topics=topics,
        rule_set=rules,
        profile=Profile() if profile is None else load_profile(Path(profile)),
    )
    return loss.measure_loss(Path(sent), Path(received), question)


def read_decisions(path: AnyPath) -> list[Decision]:
    """The decisions in the file at ``path``. Raises ``TestudoError`` for one that holds anything else."""
    return decision_log.read_decisions(Path(path))


def rows(result: Tabular | Iterable[Record]) -> list[dict[str, object]]:
    """A result of this module as rows by column, as ``pandas.DataFrame`` takes them.

    One for each topic of a recording or replay, each field of a loss, each decision, each finding.
    """
    if isinstance(result, Tabular):
        return [dict(row) for row in result.rows()]
    return [one.to_json() for one in result]


def _require_rules(rules: object) -> None:
    """Refuse what is no rule set, such as the path of a file."""
    if not isinstance(rules, RuleSet):
        raise UsageError(
            f"rules that were read are needed, not {rules!r:.40}",
            place="rules",
            remedy="give what read_rules returns",
        )


def _budget(value: float) -> float:
    try:
        return budget_kb_per_s_of(value)
    except ValueError as error:
        raise UsageError(str(error), place="budget_kb_per_s", remedy="leave it out for none") from error


def _ignore(_: object) -> None:
    """Do nothing."""
