# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The status of a live runtime at one moment, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated

from smarttestudo.domain.action import Notice
from smarttestudo.domain.decision import BoundReason, Reason
from smarttestudo.domain.incident import IncidentState
from smarttestudo.domain.link import CommandTopic, LinkState, TopicOnLink
from smarttestudo.domain.metric import Metered, MetricKind
from smarttestudo.domain.record import (
    AtMost,
    Count,
    Decimals,
    JsonEntry,
    Mark,
    Measured,
    Significant,
    derived,
    from_json,
    measured_names,
)
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.units import BYTES_PER_MB, NS_PER_MS, S_PER_HOUR

STATUS_HZ = 1.0
"""How often the status is published unless a subscriber requests more."""

MOST_BLOCKS = 1_000
"""How many blocks a status holds at most, so that it stays small whatever the rules."""

_LEAST_COUNTED_S = 10.0

MOST_UPTIME_S = 1e10
"""Three centuries; what shows a status need not say more."""

_Seconds = Annotated[float, Decimals(3)]


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckStatus:
    """One check at its place in the text; ``value`` is what it reads now, ``None`` while that is unknown.

    ``state`` is that of the check alone, also below a Not.
    """

    line: int
    column: int
    state: Truth
    value: Annotated[Annotated[float, Significant(6)] | str | None, JsonEntry(is_lenient=True)]


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeStatus:
    """One ``For`` or ``Within`` at the place of its duration.

    ``held_s`` is for how long what a ``For`` is about has held; for a ``Within``, for how long it has not.
    ``None`` while that is unknown.
    """

    line: int
    column: int
    state: Truth
    held_s: Annotated[_Seconds | None, JsonEntry(is_lenient=True)]


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockStatus:
    """The condition of one If, at its place in the rule file number ``file``, with its checks in order.

    ``held_s`` is for how long its state has been the same, ``None`` where that is not told. ``times`` are in
    the order in which they end in the text.
    """

    file: int
    line: int
    column: int
    state: Truth
    checks: Annotated[tuple[CheckStatus, ...], JsonEntry(are_rows=True, is_lenient=True)]
    held_s: Annotated[_Seconds | None, JsonEntry(is_lenient=True, omits_default=True)] = None
    times: Annotated[
        tuple[TimeStatus, ...], JsonEntry(are_rows=True, is_lenient=True, omits_default=True)
    ] = ()


class Silence(Enum):
    """Why nothing is received of a relayed topic. The first that holds counts."""

    OFF = "Off"
    NO_PUBLISHER = "no publisher"
    CANNOT_RELAY = "cannot be relayed"
    NO_SUBSCRIBER = "no subscriber"
    INCOMPATIBLE_QOS = "incompatible QoS"
    NO_MESSAGE = "no message yet"
    SOURCE_SILENT = "source is silent"


class ThinningDoubt(Enum):
    """Why a topic is not shown as its rate says."""

    PATCHES = "changes are left out"
    NO_KEY_FRAME = "no key frame found"
    KEY_FRAME_OVERDUE = "no key frame for long"

    @property
    def details(self) -> str:
        """The consequence of the doubt, and the remedy."""
        return _DETAILS[self.name]


_DETAILS = {
    "PATCHES": "each message changes a part of those before, so what is shown stays wrong; write Full",
    "NO_KEY_FRAME": "its frames cannot be told apart, so all of the video passes, whatever its rate",
    "KEY_FRAME_OVERDUE": "nothing passes before the next one; have its encoder send one each second",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessReading:
    """CPU time that a process took since its start, when that was read, and its resident memory if known."""

    cpu_ns: int
    steady_ns: int
    resident_bytes: int | None


class RulesOrigin(Enum):
    """Where the rules in force come from; the value is its name in JSON."""

    FILES = "files"
    PUSHED = "pushed"
    WAITING = "waiting"
    """Pushed, and not confirmed yet."""
    FALLBACK = "fallback"
    """There are no valid ones."""


class Fallback(Enum):
    """Relayed topics while there are no valid rules; the value is its name in JSON."""

    FULL = "full"
    """Every message."""
    READABLE = "readable"
    """Topics at the rates that can be read of rules with errors, at least 1 Hz; all others at 1 Hz."""
    OFF = "off"
    """Nothing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RulesInForce:
    """The files that the rules came from, and the SHA-256 of their text in hexadecimal.

    ``waits_s`` is how long pushed rules still hold unless they are confirmed; ``None`` where none wait.
    ``problem`` says why the rule files cannot be used as they are now; the rules in force are others.
    ``fallback`` is there while there are no valid rules.
    """

    paths: Annotated[tuple[str, ...], JsonEntry(name="files")] = ()
    sha256: str = ""
    origin: Annotated[RulesOrigin, JsonEntry(is_lenient=True)] = RulesOrigin.FILES
    waits_s: Measured | None = None
    problem: Annotated[str | None, JsonEntry(is_lenient=True, omits_default=True)] = None
    fallback: Annotated[Fallback | None, JsonEntry(is_lenient=True, omits_default=True)] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicCounts:
    """Messages of one topic since the start.

    ``received`` arrived, ``lost`` were sent and did not come, which is ``None`` while they are not numbered.
    ``relayed`` went out, ``repeated`` of those for another time, ``dropped`` were held
    back by the pacer. ``discarded`` met no decision of the topic they are paced with, ``undecodable`` could
    not be read by a check.
    """

    received: Annotated[
        Count, Metered("topic_received", "messages", "Messages that came.", MetricKind.COUNTER)
    ] = 0
    lost: Annotated[
        Count | None,
        JsonEntry(is_lenient=True, omits_default=True),
        Metered(
            "topic_lost",
            "messages",
            "Messages that were lost before they could be relayed; absent while they are not numbered.",
            MetricKind.COUNTER,
        ),
    ] = None
    relayed: Annotated[
        Count,
        Metered(
            "topic_relayed", "messages", "Messages that went out, repeated ones included.", MetricKind.COUNTER
        ),
    ] = 0
    repeated: Annotated[
        Count,
        Metered("topic_repeated", "messages", "Messages that went out for another time.", MetricKind.COUNTER),
    ] = 0
    discarded: Count = 0
    undecodable: Annotated[
        Count,
        Metered("topic_undecodable", "messages", "Messages that a check could not read.", MetricKind.COUNTER),
    ] = 0

    @property
    @derived()
    def dropped(
        self,
    ) -> Annotated[
        Count,
        Metered("topic_dropped", "messages", "Messages held back so far; the last of them may still go out."),
    ]:
        """Messages that arrived and were not relayed."""
        return self.received - (self.relayed - self.repeated)


@dataclass(frozen=True, slots=True, kw_only=True)
class LossBeforeRelay:
    """The share of a topic's messages that was lost in the last seconds, and what to do about it."""

    percent: Measured
    remedy: str


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicStatus:
    """One relayed topic.

    ``reason``, ``rule`` and ``line`` are those of its planned rate. Rates are (n − 1) / (last − first) over
    about ten seconds, those of the output since its target last changed, that of the source with what was
    lost of it before it arrived here; ``loss`` is there while that is much. ``target_hz`` is infinite for
    Full and 0 for Off, ``expected_hz`` the lesser of target and source, ``error_percent`` how far
    ``actual_hz`` lies above it, and not ``keeps_rate`` that it is off by more than pacing explains.
    ``stamped_hz`` is the rate by the messages' own header stamps and ``delay_ms`` how old the last one was
    when it was relayed. ``incompatible`` are nodes that subscribe to the output with a QoS it cannot serve,
    ``problem`` says why the topic cannot be relayed. ``frames`` counts the streams that the messages name,
    such as child frames; rates are means over them then. ``within`` are the bounds of the receiver's picture
    with their ``bound_reasons``, as in the plan. A number that the messages do not determine is ``None``.
    """

    output: str
    type_name: Annotated[str | None, JsonEntry(name="type")]
    reason: Reason
    rule: str | None
    line: int | None
    target_hz: Annotated[
        float,
        Mark.NULL_IS_INFINITE,
        Metered("topic_target", "hertz", "The planned rate of the topic; +Inf for Full, 0 for Off."),
    ]
    source_hz: Annotated[
        Measured | None, Metered("topic_source", "hertz", "Messages a second that are sent of the topic.")
    ]
    expected_hz: Annotated[
        Measured | None, Metered("topic_expected", "hertz", "The lesser of target and source.")
    ]
    actual_hz: Annotated[
        Measured | None, Metered("topic_actual", "hertz", "Messages a second that are relayed.")
    ]
    error_percent: Measured | None
    keeps_rate: Annotated[
        bool, Metered("topic_keeps_rate", "", "0 if the rate is off by more than pacing explains, else 1.")
    ]
    stamped_hz: Measured | None
    delay_ms: Annotated[
        Measured | None,
        Metered("topic_delay", "seconds", "Age of the last message by its own stamp when it was relayed."),
    ]
    in_kb_per_s: Annotated[Measured, Metered("topic_input", "bytes_per_second", "What comes of the topic.")]
    out_kb_per_s: Annotated[
        Measured, Metered("topic_output", "bytes_per_second", "What goes out of the topic to subscribers.")
    ]
    publishers: int
    subscribers: int
    incompatible: tuple[str, ...]
    problem: str | None
    silence: Annotated[Silence | None, JsonEntry(name="silent")]
    counts: Annotated[TopicCounts, JsonEntry(is_merged=True)]
    frames: Annotated[int | None, JsonEntry(omits_default=True)] = None
    loss: Annotated[LossBeforeRelay | None, JsonEntry(omits_default=True)] = None
    doubt: Annotated[ThinningDoubt | None, JsonEntry(is_lenient=True, omits_default=True)] = None
    on_link: Annotated[TopicOnLink | None, JsonEntry(name="link", omits_default=True)] = None
    within: Annotated[Mapping[str, float], JsonEntry(omits_default=True)] = field(default_factory=dict)
    bound_reasons: Annotated[Mapping[str, BoundReason], JsonEntry(omits_default=True)] = field(
        default_factory=dict
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimeStatus:
    """All of a runtime: its node, its rules, the link, itself, and its topics by source.

    ``robot`` is the robot's name on its link, empty without one; nodes of several robots may be called alike;
    ``run`` tells their runs apart.
    ``stamp_ns`` is the node's clock, ``uptime_s`` real time since the start, ``cpu_percent`` of one core
    over the last second, ``memory_mb`` what is resident. ``status_hz`` is how often a status comes,
    ``blocks`` has the states of the conditions: of the first ``MOST_BLOCKS``, ``blocks_left_out`` counts the
    others.
    """

    robot: Annotated[str, JsonEntry(omits_default=True)] = ""
    node: str
    run: Annotated[str, JsonEntry(omits_default=True)] = ""
    stamp_ns: int
    uptime_s: Annotated[
        Measured, AtMost(MOST_UPTIME_S), Metered("uptime", "seconds", "Time since the start of the run.")
    ]
    status_hz: Annotated[float, Decimals(3)] = STATUS_HZ
    rules: RulesInForce
    budget_kb_per_s: Annotated[
        float | None,
        Metered("budget", "bytes_per_second", "What relayed topics may take together, if limited."),
    ]
    floors_break_budget: Annotated[
        bool, Metered("floors_break_budget", "", "1 if the floors alone are more than the budget, else 0.")
    ]
    cpu_percent: Annotated[
        Measured | None,
        Metered("cpu", "ratio", "CPU time of the run over the last second, as a share of one core."),
    ]
    memory_mb: Annotated[Measured | None, Metered("memory", "bytes", "Resident memory of the run.")]
    topics: Mapping[str, TopicStatus]
    blocks: Annotated[tuple[BlockStatus, ...], JsonEntry(is_lenient=True)] = ()
    blocks_left_out: Annotated[int, JsonEntry(is_lenient=True, omits_default=True)] = 0
    link: Annotated[LinkState | None, JsonEntry(omits_default=True)] = None
    """The link to an operator's end, if there is one."""
    accepted: Annotated[tuple[CommandTopic, ...], JsonEntry(keyed_by="topic", omits_default=True)] = ()
    """The topics that are accepted of operators."""
    incidents: Annotated[IncidentState | None, JsonEntry(omits_default=True)] = None
    """What rules record, if that is carried out."""
    notices: Annotated[tuple[Notice, ...], JsonEntry(is_lenient=True, omits_default=True)] = ()
    """What rules notify of now."""
    sections: Annotated[Mapping[str, object], JsonEntry(is_rest=True)] = field(default_factory=dict)
    """What other parts tell of themselves: a record each, by its name; read from JSON, an object each."""

    @property
    def robot_id(self) -> str:
        """Identifier of its runtime among those of all robots: ``ada:/smarttestudo``, or the node alone."""
        return f"{self.robot}:{self.node}" if self.robot else self.node

    def mb_an_hour(self, size_bytes: int) -> float | None:
        """MB an hour, where so many bytes were put on the link since the start of the run.

        ``None`` in its first ten seconds, and where the robot does not count them.
        """
        if self.link is None or not self.link.sent_bytes or self.uptime_s < _LEAST_COUNTED_S:
            return None
        return size_bytes / BYTES_PER_MB * S_PER_HOUR / self.uptime_s

    @property
    @derived()
    def in_kb_per_s(self) -> Measured:
        """Bandwidth at which all relayed topics come in."""
        return sum(topic.in_kb_per_s for topic in self.topics.values())

    @property
    @derived()
    def out_kb_per_s(self) -> Measured:
        """The bandwidth of all output topics."""
        return sum(topic.out_kb_per_s for topic in self.topics.values())

    @property
    @derived("fallback")
    def is_fallback(
        self,
    ) -> Annotated[bool, Metered("fallback", "", "1 while there are no valid rules, else 0.")]:
        """Whether there are no valid rules."""
        return self.rules.origin is RulesOrigin.FALLBACK


_DIGITS = 4


def compact_status(status: Mapping[str, object]) -> dict[str, object]:
    """The object that goes over a link of a status in JSON.

    Measured to four digits, the stamp to the millisecond below; nothing in a block is a measurement.
    """
    record = {key: one if key == "blocks" else _shortened(one, key) for key, one in status.items()}
    stamp_ns = status["stamp_ns"]
    assert isinstance(stamp_ns, int)
    return {**record, "stamp_ns": stamp_ns // NS_PER_MS * NS_PER_MS}


def is_measured(path: tuple[str | int, ...]) -> bool:
    """Whether a number there is a measurement or a count, of which one a second is enough."""
    return path[-1:] != () and path[-1] in measured_names(RuntimeStatus)


def status_from_text(text: str) -> RuntimeStatus:
    """The status that ``text`` holds; ``ValueError`` where it is none, or one of another version.

    What an older version does not say is as it was then; what a newer one adds is left out.
    """
    try:
        record = json.loads(text)
    except RecursionError as error:
        raise ValueError(str(error)) from error
    return status_from_json(record)


def status_from_json(value: object) -> RuntimeStatus:
    """The status that a stranger's JSON value holds; ``ValueError`` as from ``status_from_text``."""
    return from_json(RuntimeStatus, _upgraded(value))


def _upgraded(value: object) -> object:
    """Add what an older version did not say: a topic is losing messages on the link if it ever did."""
    if not isinstance(value, dict):
        return value
    known = dict(value)
    if (hz := known.get("status_hz")) is None or (hz == 0 and not isinstance(hz, bool)):
        known["status_hz"] = STATUS_HZ
    if isinstance(topics := value.get("topics"), dict):
        known["topics"] = {name: _upgraded_topic(topic) for name, topic in topics.items()}
    return known


def _upgraded_topic(topic: object) -> object:
    if not isinstance(topic, dict) or not isinstance(link := topic.get("link"), dict):
        return topic
    return {**topic, "link": {"losing": bool(link.get("overflowed")), **link}}


def _shortened(value: object, name: str = "") -> object:
    if isinstance(value, dict):
        return {key: _shortened(entry, key) for key, entry in value.items()}
    if isinstance(value, float) and name in measured_names(RuntimeStatus):
        return float(f"{value:.{_DIGITS}g}")
    return value
