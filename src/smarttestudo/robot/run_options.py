# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of a live run; its parts have more."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.names import is_topic_prefix
from smarttestudo.domain.parameter import Accept, Access, Parameter, ParameterValue
from smarttestudo.domain.profile import budget_kb_per_s
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.status import STATUS_HZ
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.robot.fallback import FallbackChoice
from smarttestudo.robot.option import (
    AnyOption,
    Option,
    OptionValueError,
    Settings,
    choice,
    is_true,
    number,
    optional,
    path,
    paths,
    text,
)
from smarttestudo.robot.output_topics import DEFAULT_OUTPUT_TOPIC

MAX_STATUS_HZ = 20.0


def _topic_prefix(value: ParameterValue) -> str:
    found = str(value)
    if not is_topic_prefix(found):
        raise OptionValueError(f"a prefix is written as in /tb3_0, not {found!r}")
    return found


def _fallback(value: ParameterValue) -> FallbackChoice:
    # ROS reads "off" of a command line or a file as a boolean, as YAML does.
    return choice(FallbackChoice)(FallbackChoice.OFF.value if value is False else value)


RULES = Option(
    name="rules_file",
    flag="--rules",
    help="rule file, or list of them; folders count with all their *.adirf",
    read=paths,
    is_typed=False,
    is_shared=True,
)
FALLBACK = Option(
    name="fallback",
    flag="--fallback",
    metavar=f"{{{','.join(one.value for one in FallbackChoice)}}}",
    help="what to relay while there are no valid rules: everything at full rate, nothing (off), or rather "
    "exit; auto is full on the robot's own graph, and over a link or into another domain what can be read of "
    "rules with errors, at least 1 Hz, and 1 Hz of all other topics",
    read=_fallback,
    default=FallbackChoice.AUTO.value,
    is_typed=False,
)
RULES_TEXT = Option(
    name="rules_text",
    help="rules to follow now; reverted after 10 s unless confirm_hash is set to their hash. "
    "At the start it counts if no rule files are named. Empty while the files are in force",
    read=text,
    access=Access.ANYONE,
)
CONFIRM_HASH = Option(
    name="confirm_hash",
    help="SHA-256 of the UTF-8 text given as rules_text, to keep it",
    read=text,
    access=Access.ANYONE,
)
WRITE_HASH = Option(
    name="write_hash",
    help="SHA-256 of pushed and confirmed rules, to write them to the rule file. Set it alone",
    read=text,
    access=Access.ANYONE,
)
ALLOW_WRITING_RULES = Option(
    name="allow_writing_rules",
    flag="--allow-writing-rules",
    help="let pushed rules be written to the rule file, once they are confirmed",
    read=is_true,
    default=False,
)
WRITABLE_RULES_FILE = Option(
    name="writable_rules_file",
    help="the file that write_hash writes; empty where it may write none. Read-only",
    read=text,
    access=Access.NODE,
)
RULES_HASH = Option(
    name="rules_hash",
    help="SHA-256 of the rules in force; empty while there are none. Read-only",
    read=text,
    access=Access.NODE,
)
RULES_IN_FORCE = Option(
    name="rules_in_force",
    help="the texts of the rules in force, as a JSON object. Read-only",
    read=text,
    access=Access.NODE,
)
PROFILE = Option(
    name="profile_file",
    flag="--profile",
    help="what is known about the topics (TOML)",
    read=path,
    is_shared=True,
)
OUTPUT_TOPIC = Option(
    name="output_topic",
    flag="--output-topic",
    metavar="NAME",
    help="names of the relayed topics, with {topic} for the source's",
    read=text,
    default=DEFAULT_OUTPUT_TOPIC,
)
TOPIC_PREFIX = Option(
    name="topic_prefix",
    flag="--topic-prefix",
    metavar="NAME",
    help="what to put before every topic of the rules and the profile, as in /tb3_0",
    read=_topic_prefix,
)
WHEN_SLOW = Option(
    name="when_slow",
    flag="--when-slow",
    help="what to do where a target is above its source: pass what comes, or repeat the newest",
    read=choice(WhenSlow),
    default=WhenSlow.PASS.value,
    is_shared=True,
)
BUDGET = Option(
    name="budget_kb_per_s",
    flag="--budget",
    help="KB/s that all relayed topics together may take; no limit while it is not set",
    read=optional(budget_kb_per_s),
    default=None,
    access=Access.ANYONE,
    is_typed=False,
    is_shared=True,
)
STATUS_RATE = Option(
    name="status_hz",
    help=f"statuses a second on /testudo/status if it has a subscriber, 1 to {MAX_STATUS_HZ:g}",
    read=number("statuses a second", STATUS_HZ, MAX_STATUS_HZ),
    default=STATUS_HZ,
    access=Access.ANYONE,
    is_typed=False,
)
DECISIONS = Option(
    name="decisions_file",
    flag="--decisions",
    metavar="FILE",
    help="file to append the decisions to (JSON Lines)",
    read=path,
)
RECORD_INPUTS = Option(
    name="record_inputs",
    flag="--record-inputs",
    metavar="DIR",
    help="new folder to record the inputs of the loop in; 'testudo replay DIR' repeats the decisions",
    read=path,
)
RUN_OPTIONS: tuple[AnyOption, ...] = (
    RULES,
    FALLBACK,
    RULES_TEXT,
    CONFIRM_HASH,
    WRITE_HASH,
    ALLOW_WRITING_RULES,
    WRITABLE_RULES_FILE,
    RULES_HASH,
    RULES_IN_FORCE,
    PROFILE,
    OUTPUT_TOPIC,
    TOPIC_PREFIX,
    WHEN_SLOW,
    BUDGET,
    STATUS_RATE,
    DECISIONS,
    RECORD_INPUTS,
)


class RunParameters:
    """The node's parameters of ``options``; ``given`` are those of the command line, by name, which win.

    Raises ``UsageError`` for an invalid value.
    """

    def __init__(
        self, robot: Robot, options: Iterable[AnyOption], given: Mapping[str, ParameterValue]
    ) -> None:
        self._accept: Accept | None = None
        declared = tuple(options)
        values = robot.declare([_with(one.parameter, given) for one in declared if one.name], self._asked)
        self.settings = Settings(declared, {**given, **values})

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
