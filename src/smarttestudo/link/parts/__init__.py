# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parts of a robot's run that serve its link, imported where there is one."""

from __future__ import annotations

from smarttestudo.link.parts.options import LINK_OPTIONS
from smarttestudo.robot.part import Part, PartContext, PartKind


def _link(context: PartContext) -> Part | None:
    if context.link is None:
        return None
    from smarttestudo.link.parts.live_link import LinkPart, LinkQuestions  # noqa: PLC0415  most robots have no link

    LinkQuestions(context.robot, context.link)
    return LinkPart(context.robot, context.link)


def _command_subscribers(context: PartContext) -> Part | None:
    if context.commands is None:
        return None
    from smarttestudo.link.parts.command_subscribers import CommandSubscribers  # noqa: PLC0415  as above

    return CommandSubscribers(context.robot, context.commands, context.link)


LINK_PART = PartKind(make=_link, options=LINK_OPTIONS, title="link to an operator")
COMMANDS_PART = PartKind(make=_command_subscribers)
