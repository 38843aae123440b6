# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How a robot does, by its link, its rules and its topics: in the same words everywhere."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from smarttestudo.domain.robot import DiagnosticLevel
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import Fallback, RuntimeStatus, Silence, TopicStatus
from smarttestudo.domain.texts import first_names
from smarttestudo.domain.units import counted, duration_text

OLD_MS = 1000.0
"""A message that is older than this when it arrives is of little use for driving."""
LOST_BEFORE_RELAY = "lost before relay"
_RATE_OFF = "rate off"
_SILENCES = {
    Silence.OFF: DiagnosticLevel.OK,
    Silence.NO_PUBLISHER: DiagnosticLevel.STALE,
    Silence.CANNOT_RELAY: DiagnosticLevel.ERROR,
    Silence.NO_SUBSCRIBER: DiagnosticLevel.OK,
    Silence.INCOMPATIBLE_QOS: DiagnosticLevel.WARN,
    Silence.NO_MESSAGE: DiagnosticLevel.OK,
    Silence.SOURCE_SILENT: DiagnosticLevel.STALE,
}
_FALLBACK = {
    Fallback.FULL: "everything is relayed at full rate",
    Fallback.READABLE: "topics have the rates that can be read, at least 1 Hz, and all others 1 Hz",
    Fallback.OFF: "nothing is relayed",
}
_MEND = "mend the rule files, or push rules"
_NAMED = 3


@dataclass(frozen=True, slots=True)
class Health:
    """How bad it is, what in a few words, and the details where there are any."""

    level: DiagnosticLevel
    summary: str
    details: str = ""

    @property
    def message(self) -> str:
        """Summary and details."""
        return f"{self.summary}: {self.details}" if self.details else self.summary


def robot_health(status: RuntimeStatus, silent_s: float | None = None) -> Health:
    """The worst that is known of a robot; ``silent_s`` as for ``robot_problems``."""
    is_well = Health(DiagnosticLevel.OK, f"relaying {counted(len(status.topics), 'topic')}")
    return next(iter(robot_problems(status, silent_s)), is_well)


def robot_problems(status: RuntimeStatus, silent_s: float | None = None) -> list[Health]:
    """All that keeps a robot from what it should do, the worst first.

    ``silent_s`` is the time without a status where that is too long: then nothing else is known of it.
    """
    if silent_s is not None:
        remedy = "check that testudo run is running, and the network or radio"
        return [Health(DiagnosticLevel.ERROR, f"silent for {duration_text(silent_s)}", remedy)]
    found = [*_of_run(status), *_of_topics(status.topics), *_of_rules(status)]
    return sorted(found, key=lambda one: one.level, reverse=True)


def _of_run(status: RuntimeStatus) -> Iterator[Health]:
    if status.floors_break_budget:
        yield Health(DiagnosticLevel.ERROR, "the floors alone are more than the budget")
    if status.is_fallback:
        # A run of an older version says nothing of it, and relays everything.
        relayed = _FALLBACK[status.rules.fallback or Fallback.FULL]
        yield Health(DiagnosticLevel.ERROR, "no valid rules", f"{relayed}; {_MEND}")
    if status.rules.problem is not None:
        yield Health(DiagnosticLevel.WARN, "the rule files cannot be used as they are", status.rules.problem)
    if status.incidents is not None and status.incidents.problem is not None:
        yield Health(DiagnosticLevel.WARN, "incidents cannot be written", status.incidents.problem)
    # A robot that has a link is meant to be watched.
    if status.link is not None and not status.link.is_connected:
        yield Health(DiagnosticLevel.WARN, "no operator is connected over the link")
    budget = status.budget_kb_per_s
    if budget is not None and status.out_kb_per_s > budget:
        yield Health(
            DiagnosticLevel.WARN, "over budget", f"{status.out_kb_per_s:.1f} of {budget:.1f} KB/s are sent"
        )


def _of_topics(topics: Mapping[str, TopicStatus]) -> Iterator[Health]:
    """The faults of topics, each with all that have it; an error where none has anything else."""
    having: dict[tuple[DiagnosticLevel, str, str], list[str]] = {}
    for name, topic in topics.items():
        health = topic_health(topic)
        # A rate that is off for a moment is told of its topic.
        if health.level is not DiagnosticLevel.OK and health.summary != _RATE_OFF:
            remedy = topic.loss.remedy if health.summary == LOST_BEFORE_RELAY and topic.loss else ""
            having.setdefault((health.level, health.summary, remedy), []).append(name)
    wanted = sum(topic.silence is not Silence.OFF for topic in topics.values())
    for (level, summary, remedy), names in having.items():
        listed = first_names(names, _NAMED)
        details = f"{listed}; {remedy}" if remedy else listed
        yield Health(_of_some(level, is_all=len(names) == wanted), summary, details)


def _of_some(level: DiagnosticLevel, *, is_all: bool) -> DiagnosticLevel:
    """How bad it is for the robot that some of its topics are stale."""
    if level is not DiagnosticLevel.STALE:
        return level
    return DiagnosticLevel.ERROR if is_all else DiagnosticLevel.WARN


def _of_rules(status: RuntimeStatus) -> Iterator[Health]:
    unknown = sum(block.state is Truth.UNKNOWN for block in status.blocks)
    if unknown:
        of_all = len(status.blocks) + status.blocks_left_out
        details = f"{unknown} of {counted(of_all, 'condition')}, as a value is not known"
        level = _of_some(DiagnosticLevel.STALE, is_all=unknown == of_all)
        yield Health(level, "rules in doubt", details)


def topic_health(topic: TopicStatus) -> Health:
    """Whether a topic is relayed as it should be; if nothing is received, why."""
    incompatible = ", ".join(topic.incompatible)
    if topic.silence is not None:
        return Health(_SILENCES[topic.silence], topic.silence.value, _details(topic, incompatible))
    if incompatible:
        return Health(DiagnosticLevel.WARN, Silence.INCOMPATIBLE_QOS.value, incompatible)
    if topic.loss is not None:
        return Health(
            DiagnosticLevel.WARN, LOST_BEFORE_RELAY, f"{topic.loss.percent:.0f} %; {topic.loss.remedy}"
        )
    if topic.doubt is not None:
        return Health(DiagnosticLevel.WARN, topic.doubt.value, topic.doubt.details)
    on_link = topic.on_link
    if on_link is not None and on_link.counts.is_losing:
        lost = f"{counted(on_link.counts.overflowed, 'message')} since the start"
        return Health(DiagnosticLevel.WARN, "lost on the link", lost)
    if on_link is not None and on_link.age_ms is not None and on_link.age_ms > OLD_MS:
        return Health(DiagnosticLevel.WARN, "late", f"{on_link.age_ms / 1000:.1f} s old when it arrived")
    if not topic.keeps_rate:
        error = "" if topic.error_percent is None else f"{topic.error_percent:+.1f} %"
        return Health(DiagnosticLevel.WARN, _RATE_OFF, error)
    return Health(DiagnosticLevel.OK, "OK")


def _details(topic: TopicStatus, incompatible: str) -> str:
    if topic.silence is Silence.CANNOT_RELAY:
        return topic.problem or ""
    return incompatible if topic.silence is Silence.INCOMPATIBLE_QOS else ""
