# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Functions for scripts and notebooks, as in ``from smarttestudo import replay``.

Whatever goes wrong is a ``TestudoError`` with place, cause and remedy.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from os import PathLike
from pathlib import Path
from typing import Protocol, runtime_checkable

from smarttestudo.accuracy import recorded_loss as loss
from smarttestudo.accuracy.loss_report import LossReport
from smarttestudo.bags import measure
from smarttestudo.bags.bag_summary import BagSummary
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.remote_path import DEFAULT_TIMEOUT_S, is_url, remote_path
from smarttestudo.checks import CheckContext
from smarttestudo.domain.decision import Decision, about_rates
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.finding import Finding
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.profile import budget_kb_per_s as budget_kb_per_s_of
from smarttestudo.domain.record import to_json
from smarttestudo.files.outputs import require_separate
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop import decision_log
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.replays import replay as replaying
from smarttestudo.replays.decisions import kept_decisions
from smarttestudo.replays.outcome import ReplayOutcome
from smarttestudo.rules.findings import all_findings
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_files import find_rule_files, read_rule_text
from smarttestudo.rules.rule_sets import known_types, load_rules

AnyPath = str | PathLike[str]


@runtime_checkable
class Tabular(Protocol):
    """A result that is a table."""

    def rows(self) -> Iterable[Mapping[str, object]]:
        """Its rows, by column."""


def check_rules(*rules: AnyPath, profile: AnyPath | None = None) -> tuple[Finding, ...]:
    """Check ``rules``, files or folders of them that form one set: return what is wrong or doubtful.

    With a ``profile`` (TOML) also what breaks its budget. Raises ``TestudoError`` for what cannot be read.
    """
    known = _profile(profile)
    context = CheckContext(profile=known, types=known_types(None, known))
    files = find_rule_files(_rule_paths(rules))
    return tuple(all_findings([parse(read_rule_text(file), str(file)) for file in files], context))


def read_rules(*rules: AnyPath, profile: AnyPath | None = None) -> RuleSet:
    """The rule set that the rule files, or folders of them, ``rules`` are together.

    Quality levels need a ``profile`` (TOML). Raises ``TestudoError`` for what cannot be read, and with the
    first error where there is one.
    """
    loaded = load_rules(_rule_paths(rules), profile=_profile(profile))
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
    source, target = _recording(bag, "bag"), _path(output, "output")
    log = None if decisions is None else _path(decisions, "decisions")
    inputs = (source, None if profile is None else _path(profile, "profile"))
    require_separate({"output": target, "decisions": log}, inputs)
    with ExitStack() as opened:
        request = replaying.ReplayRequest(
            recording=opened.enter_context(open_recording(source)),
            rule_set=rules,
            output=target,
            profile=_profile(profile) or Profile(),
            when_slow=WhenSlow.REPEAT if _flag(repeat_slow, "repeat_slow") else WhenSlow.PASS,
            budget_kb_per_s=budget,
            logged=_ignore if log is None else opened.enter_context(decision_log.decision_log(log)),
        )
        return replaying.replay(request)


def measure_bag(bag: AnyPath, *, latency: bool = False) -> BagSummary:
    """How fast each topic of ``bag`` came and how much it carried, and how late with ``latency``.

    Raises ``TestudoError`` where it cannot be read.
    """
    return measure.measure_bag(_recording(bag, "bag"), _ignore, with_latency=_flag(latency, "latency"))


def measure_loss(
    sent: AnyPath,
    received: AnyPath,
    *,
    rules: RuleSet | None = None,
    profile: AnyPath | None = None,
    topics: str | Iterable[str] = (),
) -> LossReport:
    """Measure what the operator lost between the recordings ``sent`` by the robot and ``received``.

    ``rules`` give the thresholds whose crossings count, and the bounds, if ``received`` or ``sent`` has the
    decisions. ``topics`` are names or patterns, or a single one, empty for all.
    Raises ``TestudoError`` where one cannot be read, or they share nothing.
    """
    if rules is not None:
        _require_rules(rules)
    a, b = _recording(sent, "sent"), _recording(received, "received")
    question = loss.LossQuestion(
        topics=_names(topics, "topics"),
        rule_set=rules,
        decisions=() if rules is None else about_rates(kept_decisions(b, a)),
        profile=_profile(profile) or Profile(),
    )
    return loss.measure_loss(a, b, question)


def read_decisions(path: AnyPath) -> list[Decision]:
    """The decisions in the file at ``path``. Raises ``TestudoError`` for one that holds anything else."""
    return decision_log.read_decisions(_path(path, "path"))


def rows(result: Tabular | Iterable[Decision | Finding]) -> list[dict[str, object]]:
    """A result of this module as rows by column, as ``pandas.DataFrame`` takes them.

    One for each topic of a recording or replay, each field of a loss, each decision, each finding.
    """
    if isinstance(result, Tabular):
        return [dict(row) for row in result.rows()]
    try:
        return [to_json(one) for one in result]
    except (TypeError, AttributeError) as error:
        raise UsageError(
            f"a result of a function of smarttestudo is needed, not {result!r:.40}",
            place="result",
            remedy="give what replay, measure_bag, measure_loss, read_decisions or check_rules returns",
        ) from error


def _path(value: AnyPath, place: str) -> Path:
    """``value`` as a path. Raises ``UsageError`` at the parameter ``place`` for what is none."""
    path = os.fspath(value) if isinstance(value, str | PathLike) else None
    if not isinstance(path, str) or not path or "\0" in path:
        raise UsageError(
            f"the path of a file or folder is needed, not {value!r:.40}",
            place=place,
            remedy="give a text or a pathlib.Path",
        )
    return Path(path)


def _recording(value: AnyPath, place: str) -> Path:
    """The same for a recording, which may be behind a URL."""
    if isinstance(value, str) and is_url(value):
        return remote_path(value, DEFAULT_TIMEOUT_S)
    return _path(value, place)


def _rule_paths(rules: Iterable[AnyPath]) -> list[Path]:
    paths = [_path(path, "rules") for path in rules]
    if not paths:
        # An empty list of files would pass for rules in which nothing is wrong.
        raise UsageError(
            "no rule file is given", place="rules", remedy="name a rule file or a folder of them"
        )
    return paths


def _profile(value: AnyPath | None) -> Profile | None:
    return None if value is None else load_profile(_path(value, "profile"))


def _names(value: str | Iterable[str] | None, place: str) -> tuple[str, ...]:
    """Names, of which a text is one and not its letters. Raises ``UsageError`` as ``_path`` does."""
    several = (value,) if isinstance(value, str) else () if value is None else value
    names = tuple(several) if isinstance(several, Iterable) else (several,)
    if not all(isinstance(name, str) for name in names):
        raise UsageError(
            f"names are needed, not {value!r:.40}", place=place, remedy="give a text or several of them"
        )
    return names


def _flag(value: object, place: str) -> bool:
    """``value`` as a yes or no; a word such as "pass" would be a yes."""
    if isinstance(value, str):
        raise UsageError(f"True or False is needed, not {value!r:.40}", place=place, remedy="leave it out")
    return bool(value)


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
