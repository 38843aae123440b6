# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The runtime beside a robot's ROS graph."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from smarttestudo.adirf.rule_set import RuleSet
from smarttestudo.composition.live_decisions import DECISIONS_TOPIC, Decided, LiveDecisions
from smarttestudo.composition.live_run import LOOK_PERIOD_S, LiveRun
from smarttestudo.composition.replay_topics import output_name
from smarttestudo.composition.status_announcer import DIAGNOSTICS_TOPIC, STATUS_TOPIC
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import RulesInForce
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.runtime.relay_loop import RelayLoop

DEFAULT_OUTPUT_TOPIC = "/testudo{topic}"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRequest:
    """The rules, and how they are to be followed. Topics, also the profile's, are by full name.

    ``output_topic`` names monitored topics, with ``{topic}`` for the source's full name. ``decided`` are
    given the decisions. ``rules`` tell where the rules are from.
    """

    rule_set: RuleSet
    rules: RulesInForce = field(default_factory=RulesInForce)
    profile: Profile = field(default_factory=Profile)
    when_slow: WhenSlow = WhenSlow.PASS
    output_topic: str = DEFAULT_OUTPUT_TOPIC
    budget_kb_per_s: float | None = None
    decided: Sequence[Decided] = ()


def run_live(request: RunRequest, robot: Robot, stopped: Callable[[], bool]) -> None:
    """Relay until ``stopped``.

    Raises:
        RosError: decisions cannot be published at all.
        UsageError: ``output_topic`` gives no valid names, or such as are taken.
    """
    monitored = monitored_topics(request.rule_set, request.output_topic)
    decisions = LiveDecisions(robot, request.decided)
    if robot.now_ns() == 0:
        robot.log.info("Waiting for simulated time on /clock")
    while robot.now_ns() == 0 and not stopped():
        robot.wait(None, LOOK_PERIOD_S)
    if stopped():
        return
    loop = RelayLoop(
        request.rule_set, request.profile, robot.now_ns(), request.when_slow, request.budget_kb_per_s
    )
    robot.log.info(f"Relaying {len(monitored)} topics as {request.output_topic}")
    LiveRun(robot, loop, monitored, decisions, request.rules).drive(stopped)


def monitored_topics(rule_set: RuleSet, output_topic: str) -> dict[str, str]:
    """The monitored topic of each relayed one; ``UsageError`` where a name is invalid or taken."""
    monitored = {topic: output_name(topic, output_topic) for topic in rule_set.relayed}
    own = (DECISIONS_TOPIC, STATUS_TOPIC, DIAGNOSTICS_TOPIC)
    taken = {*rule_set.relayed, *(signal.topic for signal in rule_set.signals), *own}
    for topic, name in monitored.items():
        if name in taken:
            cause = f"{topic} would be relayed to {name}, which is another topic's name"
            remedy = f"choose another pattern, such as {DEFAULT_OUTPUT_TOPIC}"
            raise UsageError(cause, place="--output-topic", remedy=remedy)
    return monitored
