# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The runtime beside a robot's ROS graph."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import partial

from smarttestudo.domain.command import IncomingCommands
from smarttestudo.domain.link import OutgoingLink
from smarttestudo.domain.robot import Robot
from smarttestudo.robot.decisions import Decided, LiveDecisions
from smarttestudo.robot.fallback import Fallback
from smarttestudo.robot.incidents import LiveIncidents
from smarttestudo.robot.input_recorder import InputRecorder, Note
from smarttestudo.robot.link_questions import LinkQuestions
from smarttestudo.robot.live_run import LOOK_PERIOD_S, LiveRun, Told
from smarttestudo.robot.outages import LiveOutages
from smarttestudo.robot.output_topics import OutputTopic
from smarttestudo.robot.rule_manager import RuleManager, first_rules
from smarttestudo.robot.rule_writing import RuleFileWriter
from smarttestudo.robot.rules import LiveRuleFiles
from smarttestudo.robot.run_parameters import RunParameters


def run_live(
    parameters: RunParameters,
    robot: Robot,
    stopped: Callable[[], bool],
    decided: Sequence[Decided] = (),
    *,
    note: Note | None = None,
    link: OutgoingLink | None = None,
    commands: IncomingCommands | None = None,
    told: Told | None = None,
    catches_up: bool = False,
) -> None:
    """Relay until ``stopped``; ``decided`` are given the decisions, ``note`` what the loop is given.

    ``told`` is given each status. What ``link`` carries is the budget, and what ``robot`` publishes goes
    over it. Where it ``catches_up``, what the other end misses in outages is kept beside the
    incidents. What comes as ``commands`` is published among the robot's own nodes.

    Raises:
        OutputFileError: incidents are recorded, and their folder cannot be made.
        RosError: decisions cannot be published at all.
        UsageError: names of output topics are invalid or taken by other topics.
    """
    request = parameters.request
    resolve = partial(_resolved, robot.resolve, request.topic_prefix)
    output_topic = OutputTopic(pattern=request.output_topic, is_elsewhere=robot.has_output_domain)
    files = LiveRuleFiles(request.rules, request.profile, resolve=resolve, output_topic=output_topic)
    fallback = Fallback(robot, output_topic=output_topic, topic_prefix=request.topic_prefix)
    first = first_rules(robot, files, request.rules_text)
    decisions = LiveDecisions(robot, decided)
    if robot.now_ns() == 0:
        robot.log.info("Waiting for simulated time on /clock")
    while robot.now_ns() == 0 and not stopped():
        robot.wait(None, LOOK_PERIOD_S)
    if stopped():
        return
    if first.rules is None:
        fallback.look()
    rules = first.rules or fallback.rules()
    inputs = InputRecorder(robot, request, note)
    incidents = LiveIncidents(robot, request.incidents, resolve("/tf_static"))
    outages = LiveOutages(robot, link, request.incidents) if catches_up and link is not None else None
    live = LiveRun(
        robot,
        inputs,
        rules,
        decisions,
        link,
        incidents=incidents,
        outages=outages,
        commands=commands,
        told=told,
    )
    live.set_status_hz(request.status_hz)
    writer = RuleFileWriter(request.rules, is_allowed=request.allow_writing_rules)
    keeper = RuleManager(robot, live, files, fallback, first, writer=writer)
    with incidents.running(), nullcontext() if outages is None else outages.running(), keeper.keep():
        parameters.serve(keeper.accept)
        if link is not None:
            LinkQuestions(robot, link)
            if request.incidents.folder is not None:
                link.offer_incidents(request.incidents.folder)
        robot.log.info(f"Relaying {len(rules.output_topics)} topics as {request.output_topic}")
        live.drive(stopped)


def _resolved(resolve: Callable[[str], str], prefix: str, topic: str) -> str:
    return f"{prefix}{resolve(topic)}"
