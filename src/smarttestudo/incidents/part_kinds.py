# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of a run that write messages to disk, imported where a folder is named for that."""

from __future__ import annotations

from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB, DEFAULT_INCIDENT_RING_MAX_GB
from smarttestudo.domain.robot import RobotLog
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Option, is_true, number, optional, path
from smarttestudo.robot.part import Part, PartContext, PartKind

MAX_MEMORY_MB = 1e6
MAX_DISK_GB = 1e6
LEAST_DISK_GB = 0.001

INCIDENTS = Option(
    name="incidents",
    flag="--incidents",
    metavar="DIR",
    help="folder to write what the rules record (Record) into, a folder for each incident",
    read=path,
)
INCIDENT_MEMORY = Option(
    name="incident_memory_mb",
    flag="--incident-memory",
    metavar="MB",
    help="memory in MB for what came before an incident",
    is_number=True,
    read=number("MB", 1, MAX_MEMORY_MB),
    default=float(DEFAULT_INCIDENT_MEMORY_MB),
    is_typed=False,
)
INCIDENT_RING = Option(
    name="incident_ring",
    flag="--incident-ring",
    metavar="DIR",
    help="folder on disk for what came before an incident and does not fit into memory",
    read=path,
)
INCIDENT_RING_MAX = Option(
    name="incident_ring_max_gb",
    flag="--incident-ring-max-gb",
    metavar="GB",
    help="GB of disk that --incident-ring may take",
    is_number=True,
    read=number("GB", LEAST_DISK_GB, MAX_DISK_GB),
    default=float(DEFAULT_INCIDENT_RING_MAX_GB),
    is_typed=False,
)
INCIDENTS_MAX = Option(
    name="incidents_max_gb",
    flag="--incidents-max-gb",
    metavar="GB",
    help="GB of disk that all incidents may take: old ones are deleted, those that were read first",
    is_number=True,
    read=optional(number("GB", LEAST_DISK_GB, MAX_DISK_GB)),
    default=None,
    is_typed=False,
)
CATCH_UP = Option(
    flag="--catch-up",
    help="with --link and --incidents: keep there, too, what operators miss in outages of the link, for "
    "'testudo receive --catch-up'",
    read=is_true,
    default=False,
)


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
    make=_incidents, options=(INCIDENTS, INCIDENT_MEMORY, INCIDENT_RING, INCIDENT_RING_MAX, INCIDENTS_MAX)
)
OUTAGES_PART = PartKind(make=_outages, options=(CATCH_UP,))
