# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules from the editor to a running robot."""

from __future__ import annotations

from msgspec import Struct

from smarttestudo.domain.errors import RuleFileError
from smarttestudo.optimizer.model import Model
from smarttestudo.robot import rule_push
from smarttestudo.robot.rule_push import ConfirmAnswer, LastingAnswer, PushAnswer, PushPreview, WriteAnswer
from smarttestudo.ruler.job import job
from smarttestudo.ruler.robots.link import RobotLink, RobotRequest
from smarttestudo.ruler.rules.document import Draft, require_usable
from smarttestudo.ruler.rules.optimize import optimize_draft
from smarttestudo.rules.rule_sets import has_tiers


class PushRequest(Draft, frozen=True, kw_only=True):
    """Rules for a robot; those with errors are refused (409 with findings)."""

    node: str


class PushedRequest(Struct, frozen=True, kw_only=True):
    """Rules that were pushed to a robot, by their hash.

    A refusal by the robot is a 422 with the robot's own words.
    """

    node: str
    hash: str


@job("POST /api/push/preview", reads=True)
def preview(request: PushRequest, robots: RobotLink) -> PushPreview:
    """Compare rules with those that a robot follows.

    Raises ``RefusedTextError`` for rules with errors, ``RuleFileError`` for levels that do not fit and
    ``RosError`` if the robot does not report its rules.
    """
    robots.require_known(request.node)
    return rule_push.preview(robots, request.node, _with_rates(request), request.name)


def _with_rates(draft: Draft) -> str:
    """The rule file as a robot takes it: levels as numbers, everything else as it is."""
    checked = require_usable(draft)
    if not has_tiers([checked.document.result.file]):
        return draft.text
    outcome = optimize_draft(draft, Model.QUPER, only_named=False).outcome
    if outcome.rewritten is None:
        first = outcome.infeasible[0]
        raise RuleFileError(
            first.message, place=first.solved.subproblem.place, remedy="; ".join(first.remedies) or None
        )
    return outcome.rewritten


@job("POST /api/push")
def push(request: PushRequest, robots: RobotLink) -> PushAnswer:
    """Let a robot follow rules until they are confirmed. Raises like ``preview``, and ``RosError``."""
    return rule_push.push(robots, request.node, preview(request, robots), request.name)


@job("POST /api/push/confirm")
def confirm(request: PushedRequest, robots: RobotLink) -> ConfirmAnswer:
    """Let the pushed rules hold for good. Raises ``RosError``, where they are gone, too."""
    robots.require_known(request.node)
    return rule_push.confirm(robots, request.node, request.hash)


@job("POST /api/push/lasting", reads=True)
def lasting(request: RobotRequest, robots: RobotLink) -> LastingAnswer:
    """How long the rules last that a robot keeps. Raises ``RosError``."""
    robots.require_known(request.node)
    return rule_push.lasting(robots, request.node)


@job("POST /api/push/write")
def write(request: PushedRequest, robots: RobotLink) -> WriteAnswer:
    """Have a robot write the rules that it keeps to its file. Raises ``RosError``."""
    robots.require_known(request.node)
    return rule_push.write(robots, request.node, request.hash)
