# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks about running robots, and asks of them."""

from __future__ import annotations

import time
from collections.abc import Mapping

from smarttestudo.composition.pushed_rules import CONFIRM_WITHIN_S
from smarttestudo.composition.ruler import pushing
from smarttestudo.composition.ruler.checked_text import Draft
from smarttestudo.composition.ruler.robot_link import RobotLink
from smarttestudo.domain.errors import RosError
from smarttestudo.web import robot_schemas as schema
from smarttestudo.web.errors import RequestError
from smarttestudo.web.live_json import robot_models

_MISSING = 404


class RobotsApi:
    """The robots that ``link`` hears."""

    def __init__(self, link: RobotLink) -> None:
        self._link = link

    def robots(self) -> schema.RobotsAnswer:
        """All of them, from the first question on."""
        self._link.begin()
        models = robot_models(self._link.seen.values(), time.monotonic())
        return schema.RobotsAnswer(problem=self._link.problem, robots=models)

    def rules(self, node: str) -> schema.RobotRulesAnswer:
        """The rules that a robot follows."""
        texts = pushing.texts_of(self._link, self._known(node))
        return schema.RobotRulesAnswer(
            node=node,
            hash=texts.sha256,
            files=tuple(schema.RobotRulesFile(name=name, text=text) for name, text in texts.files),
            full_names=dict(texts.full_names),
        )

    def preview(self, request: schema.PushRequest) -> schema.PushPreview:
        """What a push would change."""
        change = pushing.compare_with_robot(self._link, self._known(request.node), _draft(request))
        return schema.PushPreview(
            differences=change.differences,
            same=change.is_same,
            hash=change.sha256,
            robot_hash=change.robot_sha256,
            text_to_send=change.text,
        )

    def push(self, request: schema.PushRequest) -> schema.PushAnswer:
        """Let a robot follow the rules until they are confirmed."""
        change = pushing.push(self._link, self._known(request.node), _draft(request))
        return schema.PushAnswer(
            state="same" if change.is_same else "staged",
            hash=change.robot_sha256 if change.is_same else change.sha256,
            confirm_within_s=CONFIRM_WITHIN_S,
            differences=change.differences,
        )

    def confirm(self, request: schema.ConfirmRequest) -> schema.ConfirmAnswer:
        """Let pushed rules hold for good."""
        pushing.confirm(self._link, self._known(request.node), request.hash)
        return schema.ConfirmAnswer(state="confirmed", hash=request.hash)

    def topics(self) -> Mapping[str, str]:
        """The types of what robots publish, as far as they can be known now."""
        if not self._link.is_up:
            return {}
        relayed = {
            topic: status.type_name
            for seen in self._link.seen.values()
            for topic, status in seen.status.topics.items()
            if status.type_name is not None
        }
        try:
            return {**relayed, **self._link.topics()}
        except RosError:
            # Words to suggest come from the files, too.
            return relayed

    def _known(self, node: str) -> str:
        """``node``, if it ever spoke: nothing is asked of any other."""
        if node not in self._link.seen:
            raise RequestError(
                f"no SmartTestudo {node} was heard",
                _MISSING,
                remedy=self._link.problem or "start `testudo run` in the same ROS domain",
            )
        return node


def _draft(request: schema.PushRequest) -> Draft:
    return Draft(
        text=request.text,
        name=request.name,
        profile_text=request.profile_text,
        profile_name=request.profile_name,
    )
