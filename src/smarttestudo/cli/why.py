# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo why``: the rate of a topic, the rule that decided it, and which values would change it."""

from __future__ import annotations

import argparse
import datetime
import math
import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress

from smarttestudo.cli.arguments import add_timeout, budget_kb_per_s, file_path
from smarttestudo.cli.commands import CommandParser
from smarttestudo.cli.link_options import add_connect, warn
from smarttestudo.cli.output import write_line
from smarttestudo.cli.robots import add_any_robot, open_chosen_robot
from smarttestudo.cli.tables import print_table
from smarttestudo.domain.action import ActionDecision, action_line
from smarttestudo.domain.decision import Decision, PlannedRate, about_rates, bound_texts
from smarttestudo.domain.errors import ProfileError, RuleFileError, UsageError
from smarttestudo.domain.health import topic_health
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.record import to_json
from smarttestudo.domain.robot import DiagnosticLevel
from smarttestudo.domain.signal import Signal
from smarttestudo.domain.status import RuntimeStatus, TopicStatus
from smarttestudo.domain.units import NS_PER_S, counted, ns_from_s, utc_time
from smarttestudo.language.evaluator import ExplainedValue, RateBorder
from smarttestudo.language.formatter import value_text
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.language.normal_form import ANY_ELEMENT, HELD, Resolve, is_derived, region_text
from smarttestudo.language.parser import parse
from smarttestudo.language.region import Region
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.block_states import values_in
from smarttestudo.loop.decision_log import read_all_decisions
from smarttestudo.loop.input_log import holds_inputs, read_inputs
from smarttestudo.replays.moment import (
    AtNs,
    RateReason,
    actions_at,
    reason_by_rules,
    reason_in_decisions,
    reason_in_inputs,
    reason_in_replay,
    recorded_decisions,
    require_relayed,
)
from smarttestudo.report.table import MISSING, Column, Table
from smarttestudo.robot.decisions import reason_words
from smarttestudo.robot.rule_push import rules_in_force
from smarttestudo.rules.profile_file import load_profile
from smarttestudo.rules.rule_sets import RuleSource, load_rules

_DIGITS = 6
_TRIES = 3
_AT_DECISION = "At the decision"
_BAG_SUFFIXES = (".db3", ".mcap", ".zstd")


def add_arguments(parser: CommandParser) -> None:
    parser.description = (
        "Say which rate a topic has, which rule decided it, what the rules read, and the nearest border of "
        "each value at which the rate would change: of a running robot now, or of what was recorded."
    )
    parser.add_argument(
        "topic",
        metavar="TOPIC",
        help="a relayed topic, as in /scan; with a file of --decisions, also a node or service of actions",
    )
    parser.add_argument(
        "record",
        metavar="RECORD",
        nargs="?",
        type=file_path,
        help="a file of --decisions, a folder of --record-inputs, a recording of /testudo/decisions, or any "
        "recording with --rules, which are replayed over it (default: a running robot)",
    )
    parser.add_argument(
        "--at",
        metavar="TIME",
        type=_moment,
        help="with RECORD: seconds since its beginning (of the last run in a file of decisions), or a local "
        "time as in 14:03, '2026-11-25 14:03:10' or 2026-11-25T13:03Z (default: its end)",
    )
    parser.add_argument(
        "--rules",
        metavar="FILE",
        nargs="+",
        action="extend",
        type=file_path,
        help="with RECORD: the rule files that decided, or that are to be replayed",
    )
    parser.add_argument(
        "--profile",
        metavar="FILE",
        type=file_path,
        help="what is known about the topics (TOML), where the rules have levels",
    )
    parser.add_argument(
        "--budget",
        metavar="N",
        type=budget_kb_per_s,
        help="with --rules and a recording: as of testudo replay",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_any_robot(parser)
    add_timeout(parser, "how long to wait for a robot")
    add_connect(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Explain one topic."""
    topic, record = resolve_topic(arguments.topic), arguments.record
    profile = None if arguments.profile is None else load_profile(arguments.profile)
    if record is None:
        for option in ("at", "rules", "budget"):
            if getattr(arguments, option) is not None:
                remedy = "name what was recorded, as in testudo why /scan decisions.jsonl"
                raise UsageError("it goes with what was recorded", place=f"--{option}", remedy=remedy)
        reason = _of_robot(arguments, topic, profile)
    elif holds_inputs(record):
        stamps = [one.stamp_ns for one in read_inputs(record)]
        reason = reason_in_inputs(
            record, topic, _at(arguments, is_whole=True)(stamps[0], stamps[0], stamps[-1])
        )
    elif record.is_file() and record.suffix not in _BAG_SUFFIXES:
        decided = read_all_decisions(record, warn)
        if actions := actions_at(decided, topic, _at(arguments, is_whole=False)):
            _print_actions(actions, as_json=arguments.json)
            return 0
        decisions = [(one.stamp_ns, one) for one in about_rates(decided)]
        reason = reason_in_decisions(
            decisions, topic, _at(arguments, is_whole=False), _rules(arguments, profile), str(record)
        )
    else:
        reason = _of_recording(arguments, topic, profile)
    if arguments.json:
        write_line(json_text(_json(reason), ascii_only=False))
    else:
        _print(reason)
    return 0


def _print_actions(actions: Sequence[ActionDecision], *, as_json: bool) -> None:
    for one in actions:
        when = f"{utc_time(one.stamp_ns)}  {action_line(one)}"
        write_line(json_text(one.to_json(), ascii_only=False) if as_json else when)


def _of_robot(arguments: argparse.Namespace, name: str, profile: Profile | None) -> RateReason:
    """Why a running robot gives ``name`` its rate, by its status and the rules that it follows."""
    with open_chosen_robot(arguments, "testudo_why") as robot:
        for _ in range(_TRIES):
            # Others may come into force between the two.
            status, texts = robot.next_status(), rules_in_force(robot, robot.robot_id)
            if status.rules.sha256 == texts.sha256:
                break
    topic = next((source for source, one in status.topics.items() if name in (source, one.output)), name)
    require_relayed(topic, status.topics)
    for line in _state_lines(status.topics[topic], status):
        warn(f"note: {topic}: {line}")
    planned = _planned(status.topics[topic])
    there = {name: one.type_name or "" for name, one in status.topics.items()}
    try:
        rule_set = _compiled(
            dict(texts.files), lambda one: texts.full_names.get(one) or resolve_topic(one), profile, there
        )
    except (RuleFileError, ProfileError) as error:
        warn(f"note: what would change the rate is not known: {error}")
        return RateReason(topic=topic, planned=planned)
    if topic not in rule_set.relayed or status.rules.sha256 != texts.sha256:
        return RateReason(topic=topic, planned=planned)
    return reason_by_rules(rule_set, topic, planned, values_in(status.blocks, rule_set))


def _compiled(
    texts: Mapping[str, str], resolve: Resolve, profile: Profile | None, there: Mapping[str, str]
) -> RuleSet:
    """The rules of a robot, which has checked them, and relays what is ``there``."""
    files = tuple(parse(text, name).file for name, text in texts.items())
    return RuleSource(files=files, profile=profile, resolve=resolve)(KnownTypes(topics=there))


def _planned(topic: TopicStatus) -> PlannedRate:
    return PlannedRate(
        rate=Rate(topic.target_hz),
        reason=topic.reason,
        rule=topic.rule,
        line=topic.line,
        within=topic.within,
        bound_reasons=topic.bound_reasons,
    )


def _state_lines(topic: TopicStatus, status: RuntimeStatus) -> Iterator[str]:
    """Notes beside the rate."""
    health = topic_health(topic)
    if health.level is not DiagnosticLevel.OK or topic.silence is not None:
        yield health.message
    if status.blocks_left_out:
        left_out = counted(status.blocks_left_out, "rule")
        yield f"the status leaves out {left_out}, whose values are unknown here"


def _of_recording(arguments: argparse.Namespace, topic: str, profile: Profile | None) -> RateReason:
    """By a replay of the rules over the recording, else by the decisions in it."""
    from smarttestudo.bags.reader import open_recording  # noqa: PLC0415  needs packages a robot lacks

    with open_recording(arguments.record) as recording:
        start_ns, end_ns = recording.start_ns, recording.end_ns
        at_ns = _at(arguments, is_whole=True)(start_ns, start_ns, end_ns)
        recorded = recorded_decisions(recording)
        decisions = [(known_ns, one) for known_ns, one in recorded if isinstance(one, Decision)]
        rule_set = _rules(arguments, profile)
        if not decisions and rule_set is not None:
            return reason_in_replay(
                recording,
                topic,
                at_ns,
                rule_set=rule_set,
                profile=profile or Profile(),
                budget_kb_per_s=arguments.budget,
            )
        return reason_in_decisions(decisions, topic, lambda *_: at_ns, rule_set, str(arguments.record))


def _rules(arguments: argparse.Namespace, profile: Profile | None) -> RuleSet | None:
    if arguments.rules is None:
        return None
    rules = load_rules(arguments.rules, profile=profile)
    rules.refuse_errors()
    return rules.rule_set


_When = Callable[[int, int, int], int]
"""The moment: by the stamp from which seconds count, that of the end, and the latest that it can be."""


def _moment(text: str) -> _When:
    """A moment from the command line; ``ArgumentTypeError`` for anything else."""
    # Python 3.10 reads no Z, and fractions of three or six digits only.
    written = re.sub(r"\.(\d{1,6})\d*", lambda found: f".{found[1]:0<6}", text.strip().replace("Z", "+00:00"))
    for read in (_seconds, _clock_time, _date_and_time):
        with suppress(ValueError):
            return read(written)
    raise argparse.ArgumentTypeError(
        f"a time is written as in 12.5 (seconds), 14:03:10 or 2026-11-25T14:03:10, not {text!r:.40}"
    )


def _seconds(text: str) -> _When:
    seconds = float(text)
    if not 0 <= seconds < math.inf:
        raise ValueError(text)
    return lambda base_ns, _end_ns, _latest_ns: base_ns + ns_from_s(seconds)


def _clock_time(text: str) -> _When:
    clock = datetime.time.fromisoformat(text)

    def at(_base_ns: int, end_ns: int, latest_ns: int) -> int:
        """On the day of the end, or on the one before."""
        last = datetime.datetime.fromtimestamp(end_ns / NS_PER_S, clock.tzinfo)
        days = (last.date(), last.date() - datetime.timedelta(days=1))
        times = [_stamp_ns(datetime.datetime.combine(day, clock)) for day in days]
        return times[0] if times[0] <= latest_ns else times[1]

    return at


def _date_and_time(text: str) -> _When:
    at_ns = _stamp_ns(datetime.datetime.fromisoformat(text))
    return lambda _base_ns, _end_ns, _latest_ns: at_ns


def _stamp_ns(at: datetime.datetime) -> int:
    """Naive times are local ones."""
    return round(at.timestamp() * 1e6) * 1000


def _at(arguments: argparse.Namespace, *, is_whole: bool) -> AtNs:
    """The moment of ``--at``, by default the end; of what ``is_whole`` there is none after that."""

    def at(first_ns: int, base_ns: int, end_ns: int) -> int:
        if arguments.at is None:
            return end_ns
        at_ns: int = arguments.at(base_ns, end_ns, end_ns if is_whole else time.time_ns())
        if at_ns < first_ns or (is_whole and at_ns > end_ns):
            cause = f"{utc_time(at_ns)} is not in it"
            remedy = f"it is from {utc_time(first_ns)} to {utc_time(end_ns)}"
            raise UsageError(cause, place="--at", remedy=remedy)
        return at_ns

    return at


_Row = tuple[ExplainedValue, "RateBorder | None"]


def _print(reason: RateReason) -> None:
    planned, asked = reason.planned, reason.asked
    is_over = reason.decision is not None and reason.decision.is_end
    write_line(f"{reason.topic}: {'no longer relayed' if is_over else planned.rate} ({_words(planned)})")
    if reason.decision is not None:
        write_line(f"since {utc_time(reason.decision.stamp_ns)}, {reason.decision.t_s:.3f} s after the start")
    for text in bound_texts(planned.within, planned.bound_reasons):
        write_line(f"within {text}")
    if asked is not None and asked.rate != planned.rate:
        write_line(f"the rules ask for {asked.rate} ({_words(asked)})")
    rows = [(one, border) for one in _shown(reason) for border in one.borders or (None,)]
    if rows:
        write_line()
        now = "Now" if reason.decision is None else "Then"
        print_table(_table(rows, _AT_DECISION if asked is None else now))


def _words(planned: PlannedRate) -> str:
    line = "" if planned.line is None else f", line {planned.line}"
    return f"{reason_words(planned)}{line}"


def _shown(reason: RateReason) -> list[ExplainedValue]:
    """The values but for how long conditions had held at a decision, which no file has."""
    return [one for one in reason.values if reason.asked is not None or not _is_held(one.signal)]


def _is_held(signal: Signal) -> bool:
    return signal.property == HELD and is_derived(signal)


def _table(rows: Sequence[_Row], now: str) -> Table[_Row]:
    is_of_decision = now == _AT_DECISION

    def beyond(row: _Row) -> str:
        if row[1] is None:
            return MISSING if is_of_decision else "no value of it alone changes the rate"
        request = row[1].request
        if is_of_decision:
            return "the rule no longer holds" if request.rate.is_off else "the rule holds"
        return f"{request.rate} ({_words(request)}){', once that has lasted' * row[1].is_lasting}"

    return Table(
        columns=(
            Column("Value", "", lambda row: _name(row[0].signal), is_text=True),
            Column(now, "", lambda row: _value(row[0]), is_text=True),
            Column(
                "Border",
                "",
                lambda row: MISSING if row[1] is None else _where(row[0].signal, row[1]),
                is_text=True,
            ),
            Column("Beyond it", "", beyond, is_text=True),
        ),
        rows=rows,
    )


def _name(signal: Signal) -> str:
    if _is_any(signal):
        return signal.topic
    return f"seconds of {signal.topic}" if _is_held(signal) else str(signal)


def _is_any(signal: Signal) -> bool:
    return signal.property == ANY_ELEMENT and is_derived(signal)


def _value(one: ExplainedValue) -> str:
    if one.value is not None and _is_any(one.signal):
        return value_text(one.value == 1)
    return value_text(one.value) if isinstance(one.value, str) else _number(one.value)


def _where(signal: Signal, border: RateBorder) -> str:
    """Where a value lies beyond a border; whether any element does something is true or false."""
    if _is_any(signal) and isinstance(border.where, Region):
        return value_text(border.where.contains(1.0))
    return region_text(border.where)


def _number(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.{_DIGITS}g}"


def _json(reason: RateReason) -> dict[str, object]:
    return {
        "topic": reason.topic,
        **to_json(reason.planned),
        "asked": None if reason.asked is None else to_json(reason.asked),
        "decision": None if reason.decision is None else reason.decision.to_json(),
        "values": [_value_json(one, reason) for one in _shown(reason)],
    }


def _value_json(one: ExplainedValue, reason: RateReason) -> dict[str, object]:
    borders = [
        {
            "where": _where(one.signal, border),
            **(
                {"holds": not border.request.rate.is_off} if reason.asked is None else to_json(border.request)
            ),
            "lasting": border.is_lasting,
        }
        for border in one.borders
    ]
    is_infinite = isinstance(one.value, float) and math.isinf(one.value)
    value = {"value": None, "infinite": str(one.value)} if is_infinite else {"value": one.value}
    return {"signal": _name(one.signal), **value, "borders": borders}
