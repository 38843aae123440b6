# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The report of a replay: both recordings beside each other, and every decision."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path

from smarttestudo import __version__
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.profile import Profile
from smarttestudo.replays.outcome import ReplayOutcome
from smarttestudo.report.bag_report import Progress, ReportRequest, bag_report
from smarttestudo.report.run_report import Fact, RunReport
from smarttestudo.rules.rule_sets import LoadedRules

_EXPLANATION = (
    "Source is the recording. SmartTestudo is what an operator would have received of the relayed topics, "
    "each at the rate that the rules gave it."
)


def replay_report(
    *,
    bag: Path,
    output: Path,
    outcome: ReplayOutcome,
    decisions: Sequence[Decision],
    predict: Collection[str],
    profile: Profile,
    budget_kb_per_s: float | None,
    rules: LoadedRules,
    progress: Progress,
) -> RunReport:
    """The report on the relayed topics of which there were messages; reads both recordings once more.

    Raises:
        RecordingError: one of them cannot be read.
    """
    output_topics = {
        topic: relayed.output_topic for topic, relayed in outcome.topics.items() if relayed.messages_in
    }
    return bag_report(
        ReportRequest(
            a=bag,
            b=output,
            title=f"Replay of {bag.resolve().name}",
            explanation=_EXPLANATION,
            mapping=output_topics,
            topics=tuple(output_topics),
            rule_set=rules.rule_set,
            rule_texts=rules.texts,
            decisions=decisions,
            predict=predict,
            profile=profile,
            budget_kb_per_s=budget_kb_per_s,
            provenance=(
                Fact(label="SmartTestudo", value=__version__),
                Fact(label="Recording", value=str(bag)),
                Fact(label="Output recording", value=str(output)),
            ),
            progress=progress,
        )
    )
