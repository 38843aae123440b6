# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The part of a run that does what rules ask for beside relaying and recording, with its options."""

from __future__ import annotations

import os
from pathlib import Path

from smarttestudo.actions.live_actions import LiveActions
from smarttestudo.actions.restore_file import RestoreFile
from smarttestudo.actions.webhook import Webhook, WebhookUrl
from smarttestudo.domain.parameter import ParameterValue
from smarttestudo.robot.option import Option, OptionValueError, is_true, path
from smarttestudo.robot.part import Part, PartContext, PartKind


def _url(value: ParameterValue) -> str | None:
    if not value:
        return None
    try:
        return WebhookUrl.read(str(value)).text
    except ValueError as error:
        raise OptionValueError(str(error)) from None


DRY_ACTIONS = Option(
    name="dry_actions",
    flag="--dry-actions",
    help="decide what rules set, call and notify, and do nothing of it",
    read=is_true,
    default=False,
)
NOTIFY = Option(
    # No parameter of the node: whoever reads it could send what they like there.
    flag="--notify",
    metavar="URL",
    help="where to send what rules notify (Notify), as a POST of JSON each",
    read=_url,
)
RESTORE_FILE = Option(
    name="restore_file",
    flag="--restore-file",
    metavar="FILE",
    help="file that remembers what parameters were before rules set them (default: one for each node and ROS "
    "domain in ~/.local/state/smarttestudo)",
    read=path,
)


def _actions(context: PartContext) -> Part:
    settings, robot = context.settings, context.robot
    webhook, notify = None, settings[NOTIFY]
    if notify is not None:
        url = WebhookUrl.read(notify)
        webhook = Webhook(url.host, url.post, robot.log.warning)
    file = RestoreFile(settings[RESTORE_FILE] or _usual_file(robot.name))
    return LiveActions(robot, file, webhook, is_dry=settings[DRY_ACTIONS])


def _usual_file(node: str) -> Path | None:
    """Where a run remembers what nobody named a file for; ``None`` where the user has no folder."""
    name = f"{os.environ.get('ROS_DOMAIN_ID') or '0'}{node.replace('/', '-')}.json"
    try:
        state = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
    except RuntimeError:
        return None
    return Path(state) / "smarttestudo" / name


ACTIONS_PART = PartKind(make=_actions, options=(DRY_ACTIONS, NOTIFY, RESTORE_FILE))
