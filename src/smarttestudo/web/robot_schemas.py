# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the Ruler's page and server say to each other about robots, in JSON.

A robot here is a running ``testudo run``, named by its node (``/smarttestudo``). Rates are in Hz, bandwidths
in KB/s of 1000 B, and null is "not known", but for ``target_hz``, where it is Full.
"""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

RulesOriginName = Literal["files", "pushed", "waiting", "fallback"]
StateName = Literal["true", "false", "unknown"]


class RobotModel(Struct, frozen=True, kw_only=True):
    """One robot. ``rules`` says where its rules come from; ``waiting``: pushed, and not confirmed yet.

    ``waits_s`` is how long those still hold unless they are confirmed. ``is_heard`` is false once it has
    been silent for longer than it should be; ``heard_s_ago`` is the time since its last status.
    """

    node: str
    is_heard: bool
    heard_s_ago: float
    rules_hash: str
    rules_files: tuple[str, ...]
    rules: RulesOriginName
    waits_s: float | None
    topics: int


class RobotsAnswer(Struct, frozen=True, kw_only=True):
    """``GET /api/robots``; ``problem`` says why ROS cannot be reached, null where it can."""

    problem: str | None
    robots: tuple[RobotModel, ...]


class RobotRulesFile(Struct, frozen=True, kw_only=True):
    """A rule file that a robot follows."""

    name: str
    text: str


class RobotRulesAnswer(Struct, frozen=True, kw_only=True):
    """``GET /api/robots/rules?node=``: the rules in force; no files while everything is relayed.

    ``full_names`` are those of topics that the texts call otherwise.
    """

    node: str
    hash: str
    files: tuple[RobotRulesFile, ...]
    full_names: dict[str, str]


class PushRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/push/preview`` → ``PushPreview``; ``POST /api/push`` → ``PushAnswer``.

    Both refuse (409 with findings) rules with errors.
    """

    node: str
    text: str
    name: str = "rules.adirf"
    profile_text: str | None = None
    profile_name: str = "profile.toml"


class PushPreview(Struct, frozen=True, kw_only=True):
    """What a push would change, in sentences; ``same`` where it is nothing.

    ``text_to_send`` has numbers in the place of quality levels, since a robot may have no profile; ``hash``
    is its SHA-256. ``robot_hash`` is that of what the robot follows now.
    """

    differences: tuple[str, ...]
    same: bool
    hash: str
    robot_hash: str
    text_to_send: str


class PushAnswer(Struct, frozen=True, kw_only=True):
    """``staged``: the rules hold for ``confirm_within_s``, and for good once ``hash`` is confirmed.

    ``same``: nothing was sent, since the robot follows these rules already; ``hash`` is that of what it has.
    A refusal by the robot is a 422 with the robot's own words.
    """

    state: Literal["staged", "same"]
    hash: str
    confirm_within_s: float
    differences: tuple[str, ...]


class ConfirmRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/push/confirm`` → ``ConfirmAnswer``: keep the rules that were pushed."""

    node: str
    hash: str


class ConfirmAnswer(Struct, frozen=True, kw_only=True):
    """The pushed rules hold for good."""

    state: Literal["confirmed"]
    hash: str


class MeasureLiveRequest(Struct, frozen=True, kw_only=True):
    """``POST /api/profile/measure-live`` → ``TextAnswer``: a profile of what the robot's nodes publish now.

    ``run`` names it in the ``Progress`` messages of ``/ws``.
    """

    seconds: float
    run: str = ""


class Watch(Struct, frozen=True, kw_only=True, tag_field="kind", tag="watch"):
    """The page asks on ``/ws`` for ``Live`` of one robot; null ends that. At most 20 a second."""

    node: str | None
    update_hz: float = 5.0


class RobotsPush(Struct, frozen=True, kw_only=True, tag_field="kind", tag="robots"):
    """``RobotsAnswer`` on ``/ws``: when something changes, and every two seconds."""

    problem: str | None
    robots: tuple[RobotModel, ...]


class LiveTopic(Struct, frozen=True, kw_only=True):
    """A relayed topic now; ``topic`` is its full name, ``reason`` and ``rule`` are those of its rate.

    ``silence`` says why nobody receives anything, ``problem`` why it cannot be relayed.
    """

    topic: str
    output: str
    type: str | None
    source_hz: float | None
    target_hz: float | None
    actual_hz: float | None
    error_percent: float | None
    keeps_rate: bool
    out_kb_per_s: float
    in_kb_per_s: float
    rule: str | None
    line: int | None
    reason: str
    silence: str | None
    problem: str | None


class LiveBlock(Struct, frozen=True, kw_only=True):
    """The condition of a rule, at its place in the robot's file number ``file``.

    ``label`` is what decisions call it; empty until the robot's rules were read.
    """

    file: int
    line: int
    column: int
    state: StateName
    label: str


class LiveCheck(Struct, frozen=True, kw_only=True):
    """A check at its place in the robot's file number ``file``, and the value that it reads.

    The words of the check, as written there, find it in another text: what it says of a value does not depend
    on its place. They are empty until the robot's rules were read.
    """

    file: int
    line: int
    column: int
    state: StateName
    value: float | None
    topic: str
    property: str
    op: str
    limit: float | None


class Live(Struct, frozen=True, kw_only=True, tag_field="kind", tag="live"):
    """What a robot does now; ``stamp_s`` is its own clock, in seconds since 1970.

    ``status_kb_per_s`` is what its statuses themselves take of the link at most, ``full_names`` are those of
    topics that its rules call otherwise.
    """

    node: str
    stamp_s: float
    rules_hash: str
    rules: RulesOriginName
    waits_s: float | None
    cpu_percent: float | None
    memory_mb: float | None
    budget_kb_per_s: float | None
    out_kb_per_s: float
    status_kb_per_s: float
    topics: tuple[LiveTopic, ...]
    blocks: tuple[LiveBlock, ...]
    checks: tuple[LiveCheck, ...]
    full_names: dict[str, str]
