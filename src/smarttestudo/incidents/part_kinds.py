# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of a run that write messages to disk, imported where a folder is named for that."""

from __future__ import annotations

from smarttestudo.domain.robot import RobotLog
from smarttestudo.incidents.options import (
    CATCH_UP,
    INCIDENT_MEMORY,
    INCIDENT_RING,
    INCIDENT_RING_MAX,
    INCIDENTS,
    INCIDENTS_MAX,
)
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.part import Part, PartContext, PartKind

_WITHOUT_FOLDER = "the rules have a Record, and no folder is named to record into: --incidents DIR does"


class WithoutIncidents(Part):
    """Warns once where rules record and there is no folder for it."""

    def __init__(self, log: RobotLog) -> None:
        self._log = log
        self._has_said = False

    def follow(self, rules: LiveRules, now_ns: int) -> None:  # noqa: ARG002 - a part's
        """Note whether these rules record."""
        if rules.rule_set.has_recordings and not self._has_said:
            self._has_said = True
            self._log.warning(_WITHOUT_FOLDER)


def _incidents(context: PartContext) -> Part:
    folder = context.settings[INCIDENTS]
    if folder is None:
        return WithoutIncidents(context.robot.log)
    from smarttestudo.incidents.live_incidents import LiveIncidents  # noqa: PLC0415  most runs record nothing

    return LiveIncidents(context, folder)


def _outages(context: PartContext) -> Part | None:
    folder, link = context.settings[INCIDENTS], context.link
    if not context.settings[CATCH_UP] or folder is None or link is None:
        return None
    from smarttestudo.incidents.live_outages import LiveOutages  # noqa: PLC0415  most runs keep nothing

    return LiveOutages(context.robot, link, folder, context.settings)


INCIDENTS_PART = PartKind(
    make=_incidents,
    options=(INCIDENTS, INCIDENT_MEMORY, INCIDENT_RING, INCIDENT_RING_MAX, INCIDENTS_MAX),
)
OUTAGES_PART = PartKind(make=_outages, options=(CATCH_UP,))
