# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The runtime beside a robot's ROS graph."""

from __future__ import annotations

import gc
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

from smarttestudo.domain.link import IncomingCommands
from smarttestudo.domain.names import is_own_output, resolved_pattern
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import Fallback
from smarttestudo.domain.units import counted
from smarttestudo.robot.decisions import Decided, LiveDecisions
from smarttestudo.robot.fallback import FallbackTopics
from smarttestudo.robot.input_recorder import InputRecorder, Note
from smarttestudo.robot.live_run import POLL_PERIOD_S, LiveRun
from smarttestudo.robot.option import AnyOption
from smarttestudo.robot.output_topics import OutputTopic
from smarttestudo.robot.part import PartContext, PartKind
from smarttestudo.robot.rule_manager import RuleManager, first_rules
from smarttestudo.robot.rule_writing import RuleFileWriter
from smarttestudo.robot.rules import LiveRuleFiles
from smarttestudo.robot.run_options import (
    ALLOW_WRITING_RULES,
    FALLBACK,
    OUTPUT_TOPIC,
    PROFILE,
    RULES,
    RULES_TEXT,
    RUN_OPTIONS,
    STATUS_RATE,
    TOPIC_PREFIX,
    RunParameters,
)
from smarttestudo.robot.seen_topics import SeenTopics
from smarttestudo.rules.rule_files import refuse_missing

if TYPE_CHECKING:
    from smarttestudo.domain.link import OutgoingLink


def options_of(kinds: Sequence[PartKind]) -> tuple[AnyOption, ...]:
    """The options of a run with parts of these ``kinds``."""
    return (*RUN_OPTIONS, *(option for kind in kinds for option in kind.options))


def run_live(
    parameters: RunParameters,
    robot: Robot,
    stopped: Callable[[], bool],
    kinds: Sequence[PartKind],
    decided: Sequence[Decided] = (),
    *,
    note: Note | None = None,
    link: OutgoingLink | None = None,
    commands: IncomingCommands | None = None,
) -> None:
    """Relay until ``stopped``, with parts of these ``kinds``.

    ``decided`` are given the decisions, ``note`` what the loop is given. What ``link`` carries is the budget,
    and what ``robot`` publishes goes over it. What comes as ``commands`` is published among the robot's own
    nodes.

    Raises:
        OutputFileError: incidents are recorded, and their folder cannot be made.
        RuleFileError: a rule file is not there, or no rules are valid and ``--fallback`` says to end then.
        RosError: decisions cannot be published at all.
        UsageError: names of output topics are invalid or taken by other topics.
    """
    settings = parameters.settings
    prefix = settings[TOPIC_PREFIX]

    def resolve(topic: str) -> str:
        return f"{prefix}{resolved_pattern(topic, robot.resolve)}"

    output_topic = OutputTopic.of(robot, settings[OUTPUT_TOPIC])
    writer = RuleFileWriter(settings[RULES], is_allowed=settings[ALLOW_WRITING_RULES])
    if not writer.file:
        refuse_missing(settings[RULES])
    relays = settings[FALLBACK].what_is_relayed(
        leaves_graph=link is not None or robot.has_output_domain,
        has_rules=bool(settings[RULES] or settings[RULES_TEXT]),
    )
    fallback = FallbackTopics(robot, output_topic=output_topic, topic_prefix=prefix, relays=relays)
    seen = SeenTopics(robot, lambda topic: not is_own_output(topic, output_topic.pattern))
    files = LiveRuleFiles(
        settings[RULES],
        settings[PROFILE],
        resolve=resolve,
        output_topic=output_topic,
        known=seen.known,
        reads_broken=relays is Fallback.READABLE,
    )
    first = first_rules(robot, files, settings, fallback)
    context = PartContext(robot=robot, settings=settings, resolve=resolve, link=link, commands=commands)
    if not _clock_runs(robot, stopped):
        return
    if first.rules is None:
        fallback.poll()
    rules = first.rules or fallback.rules()
    inputs = InputRecorder(robot, settings, note)
    parts = [part for kind in kinds if (part := kind.make(context)) is not None]
    decisions = LiveDecisions(robot, [*decided, *(part.on_decisions for part in parts)])
    live = LiveRun(robot, inputs, rules, decisions, parts=parts, link=link)
    live.set_status_hz(settings[STATUS_RATE])
    keeper = RuleManager(robot, live, files, fallback, first, seen=seen, writer=writer)
    with ExitStack() as running:
        for part in parts:
            running.enter_context(part.running())
        running.enter_context(keeper.keep())
        parameters.serve(keeper.accept)
        # What is made at the start stays: to look for cycles in it would hold up messages.
        gc.freeze()
        robot.log.info(f"Relaying {counted(len(rules.output_topics), 'topic')} as {settings[OUTPUT_TOPIC]}")
        live.drive(stopped)


def _clock_runs(robot: Robot, stopped: Callable[[], bool]) -> bool:
    """Wait for simulated time, where that is used; whether it came before ``stopped``."""
    if robot.now_ns() == 0:
        robot.log.info("Waiting for simulated time on /clock")
    while robot.now_ns() == 0 and not stopped():
        robot.wait(None, POLL_PERIOD_S)
    return not stopped()
