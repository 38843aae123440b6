# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a live run, from its command line or the parameters of its node."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from smarttestudo.domain.budget import budget_kb_per_s
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.incident import DEFAULT_INCIDENT_MEMORY_MB, DEFAULT_INCIDENT_RING_MAX_GB
from smarttestudo.domain.names import is_topic_prefix
from smarttestudo.domain.parameter import Accept, Access, Parameter, ParameterValue
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import STATUS_HZ
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.robot.incidents import IncidentOptions
from smarttestudo.robot.output_topics import DEFAULT_OUTPUT_TOPIC

MAX_STATUS_HZ = 20.0
PARAMETERS = (
    Parameter(
        name="rules_file",
        description="Rule file, or list of them; folders count with all their *.adirf.",
        value="",
        is_typed=False,
    ),
    Parameter(
        name="rules_text",
        description="Rules to follow now; reverted after 10 s unless confirm_hash is set to their hash. "
        "At the start it counts if no rule files are named. Empty while the files are in force.",
        value="",
        access=Access.ANYONE,
    ),
    Parameter(
        name="confirm_hash",
        description="SHA-256 of the UTF-8 text given as rules_text, to keep it.",
        value="",
        access=Access.ANYONE,
    ),
    Parameter(
        name="write_hash",
        description="SHA-256 of pushed and confirmed rules, to write them to the rule file. Set it alone.",
        value="",
        access=Access.ANYONE,
    ),
    Parameter(
        name="allow_writing_rules",
        description="Whether write_hash may write pushed rules to the rule file.",
        value=False,
    ),
    Parameter(
        name="writable_rules_file",
        description="The file that write_hash writes; empty where it may write none. Read-only.",
        value="",
        access=Access.NODE,
    ),
    Parameter(
        name="rules_hash",
        description="SHA-256 of the rules in force; empty while there are none. Read-only.",
        value="",
        access=Access.NODE,
    ),
    Parameter(
        name="rules_in_force",
        description="The texts of the rules in force, as a JSON object. Read-only.",
        value="",
        access=Access.NODE,
    ),
    Parameter(name="profile_file", description="What is known about the topics (TOML).", value=""),
    Parameter(
        name="output_topic",
        description="Name of the relayed topics, with {topic} for the source's.",
        value=DEFAULT_OUTPUT_TOPIC,
    ),
    Parameter(
        name="topic_prefix",
        description="What to put before every topic of the rules and the profile, as in /tb3_0.",
        value="",
    ),
    Parameter(
        name="when_slow",
        description="What to do where a target is above its source: pass what comes, or repeat the newest.",
        value=WhenSlow.PASS.value,
    ),
    Parameter(
        name="budget_kb_per_s",
        description="KB/s that all relayed topics together may take; no limit while it is not set.",
        value=None,
        access=Access.ANYONE,
        is_typed=False,
    ),
    Parameter(
        name="status_hz",
        description=f"Statuses a second on /testudo/status if it has a subscriber, 1 to {MAX_STATUS_HZ:g}.",
        value=STATUS_HZ,
        access=Access.ANYONE,
        is_typed=False,
    ),
    Parameter(name="decisions_file", description="File to append the decisions to (JSON Lines).", value=""),
    Parameter(
        name="record_inputs",
        description="New folder for the recorded inputs of the loop, for testudo replay.",
        value="",
    ),
    Parameter(
        name="incidents",
        description="Folder for what the rules record (Record), a folder for each incident.",
        value="",
    ),
    Parameter(
        name="incident_memory_mb",
        description="MB of memory for what came before an incident.",
        value=float(DEFAULT_INCIDENT_MEMORY_MB),
        is_typed=False,
    ),
    Parameter(
        name="incident_ring",
        description="Folder on disk for what came before an incident and does not fit into memory.",
        value="",
    ),
    Parameter(
        name="incident_ring_max_gb",
        description="GB of disk for what does not fit into memory.",
        value=float(DEFAULT_INCIDENT_RING_MAX_GB),
        is_typed=False,
    ),
    Parameter(
        name="incidents_max_gb",
        description="GB of disk that all incidents may take; old ones are deleted. No limit while not set.",
        value=None,
        is_typed=False,
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRequest:
    """The rules, and how they are to be followed.

    ``output_topic`` names output topics, with ``{topic}`` for the source's full name. ``rules`` may be
    folders; ``rules_text`` counts where there are none. ``allow_writing_rules``: pushed rules may be written
    to the rule file.
    """

    rules: tuple[Path, ...] = ()
    rules_text: str = ""
    allow_writing_rules: bool = False
    profile: Path | None = None
    output_topic: str = DEFAULT_OUTPUT_TOPIC
    topic_prefix: str = ""
    when_slow: WhenSlow = WhenSlow.PASS
    budget_kb_per_s: float | None = None
    status_hz: float = STATUS_HZ
    decisions: Path | None = None
    record_inputs: Path | None = None
    incidents: IncidentOptions = field(default_factory=IncidentOptions)


class RunParameters:
    """The node's parameters; ``given`` are those of the command line, by name, which win.

    Raises ``UsageError`` for an invalid value.
    """

    def __init__(self, robot: Robot, given: Mapping[str, ParameterValue]) -> None:
        self._accept: Accept | None = None
        values = robot.declare([_with(one, given) for one in PARAMETERS], self._asked)
        self.request = _request(values)

    def serve(self, accept: Accept) -> None:
        """Have ``accept`` called from now on before parameters change; until then none may change."""
        self._accept = accept

    def _asked(self, changes: Mapping[str, ParameterValue]) -> None:
        if self._accept is None:
            raise UsageError("the run has not begun yet", place=", ".join(changes), remedy="try again")
        self._accept(changes)


def _with(one: Parameter, given: Mapping[str, ParameterValue]) -> Parameter:
    value = given.get(one.name)
    return one if value is None else replace(one, value=value, is_final=True)


def _request(values: Mapping[str, ParameterValue]) -> RunRequest:
    return RunRequest(
        rules=tuple(Path(name) for name in _names(values["rules_file"])),
        rules_text=str(values["rules_text"]),
        allow_writing_rules=values["allow_writing_rules"] is True,
        profile=_path(values["profile_file"]),
        output_topic=str(values["output_topic"]),
        topic_prefix=_topic_prefix(values["topic_prefix"]),
        when_slow=_when_slow(values["when_slow"]),
        budget_kb_per_s=budget_parameter(values["budget_kb_per_s"]),
        status_hz=status_hz_parameter(values["status_hz"]),
        decisions=_path(values["decisions_file"]),
        record_inputs=_path(values["record_inputs"]),
        incidents=IncidentOptions(
            folder=_path(values["incidents"]),
            memory_mb=_positive(values["incident_memory_mb"], "incident_memory_mb"),
            ring=_path(values["incident_ring"]),
            ring_max_gb=_positive(values["incident_ring_max_gb"], "incident_ring_max_gb"),
            max_gb=_limit(values["incidents_max_gb"], "incidents_max_gb"),
        ),
    )


def budget_parameter(value: ParameterValue) -> float | None:
    """The budget in KB/s, if there is one. Raises ``UsageError``."""
    try:
        return None if value is None else budget_kb_per_s(value)
    except ValueError as error:
        raise UsageError(str(error), place="parameter budget_kb_per_s") from error


def status_hz_parameter(value: ParameterValue) -> float:
    """Statuses a second. Raises ``UsageError``."""
    if isinstance(value, int | float) and not isinstance(value, bool) and STATUS_HZ <= value <= MAX_STATUS_HZ:
        return float(value)
    cause = f"it is a number from {STATUS_HZ:g} to {MAX_STATUS_HZ:g}, not {value!r}"
    raise UsageError(cause, place="parameter status_hz")


def _positive(value: ParameterValue, name: str) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool) and 0 < value < math.inf:
        return float(value)
    raise UsageError(f"it is a number above 0, not {value!r}", place=f"parameter {name}")


def _limit(value: ParameterValue, name: str) -> float | None:
    return None if value is None else _positive(value, name)


def _names(value: ParameterValue) -> tuple[str, ...]:
    names = value if isinstance(value, tuple) else (value,)
    if not all(isinstance(name, str) for name in names):
        raise UsageError("it is a name or a list of names", place="parameter rules_file")
    return tuple(str(name) for name in names if name)


def _path(value: ParameterValue) -> Path | None:
    return Path(str(value)) if value else None


def _topic_prefix(value: ParameterValue) -> str:
    text = str(value)
    if not is_topic_prefix(text):
        raise UsageError(f"a prefix is written as in /tb3_0, not {text!r}", place="parameter topic_prefix")
    return text


def _when_slow(value: ParameterValue) -> WhenSlow:
    for mode in WhenSlow:
        if mode.value == value:
            return mode
    known = " or ".join(mode.value for mode in WhenSlow)
    raise UsageError(f"it is {known}, not {value!r}", place="parameter when_slow")
