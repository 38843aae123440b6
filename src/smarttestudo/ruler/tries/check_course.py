# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values of a check over a recording, and when it and its condition hold."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from msgspec import Struct

from smarttestudo.bags.incident_record import record_beside
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.names import is_source
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.signal import Signal, Value, shown_value
from smarttestudo.domain.units import NS_PER_S, grouped
from smarttestudo.editing import inserted_all, read_document
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.recordings import READING
from smarttestudo.ruler.job import Report, job
from smarttestudo.ruler.rules.document import Draft, require_usable
from smarttestudo.ruler.rules.statement_trees import new_statement, value_words
from smarttestudo.ruler.rules.statements import (
    CheckCondition,
    Compared,
    Condition,
    FullRate,
    RuleStatement,
    SetStatement,
    TimedCondition,
)
from smarttestudo.ruler.tries.try_rules import compiled_for
from smarttestudo.ruler.tries.watches import BlockTurns, TruthWatch

MAX_BINS = 1000
MAX_TURNS = 2000


class CheckCourseRequest(Struct, frozen=True, kw_only=True):
    """A check over a bag, and the ``For`` or ``Within`` on it.

    ``run`` names the work in ``Progress`` messages of ``/ws``. ``profile_text`` says how levels are read.
    """

    bag: str
    condition: Condition
    profile_text: str | None = None
    run: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckCourse:
    """The values of a check's property in bins of ``bin_s``, and what held when; times are since the start.

    Of an incident that is the start of its window, and ``duration_s`` is as long as that.
    ``least`` and ``greatest`` are those that the check met in each bin, null where it was unknown
    throughout. Of one that compares with no number, ``words`` say what it read from when on, null where that
    was unknown. ``check`` and ``condition`` say what each turned to when; all these turn at most 2000 times.
    """

    duration_s: float
    bin_s: float
    least: tuple[float | None, ...]
    greatest: tuple[float | None, ...]
    words: tuple[tuple[float, str | None], ...]
    check: BlockTurns
    condition: BlockTurns
    notices: tuple[str, ...]


@job("POST /api/check/course", reads=True, limit=READING)
def check_course(request: CheckCourseRequest, folder: ProjectFolder, report: Report) -> CheckCourse:
    """Replay the bag with that check alone.

    Raises:
        EditError: the condition cannot be written.
        RefusedTextError: it has errors.
        UsageError: it is no check, nor a ``For`` or ``Within`` on one.
        RecordingError: the bag cannot be read.
    """
    bag = folder.bag(request.bag)
    draft = _draft(request)
    require_usable(draft)
    with open_recording(bag) as recording:
        rule_set = compiled_for(draft, recording)
        record = record_beside(bag)
        start_ns = recording.start_ns if record is None else record.from_ns
        end_ns = recording.end_ns if record is None else record.to_ns
        truths = TruthWatch(rule_set, start_ns, max_turns=MAX_TURNS)
        compared = _check_in(request.condition).value
        values = _ValueWatch(_signal_of(rule_set), compared, start_ns, end_ns)

        def stepped(now_ns: int, loop: RelayLoop) -> None:
            truths.stepped(now_ns, loop)
            values.stepped(now_ns, loop)

        outcome = replay(
            ReplayRequest(
                recording=recording,
                rule_set=rule_set,
                output=None,
                profile=draft.profile() or Profile(),
                report=report,
                arrived=values.arrived,
                stepped=stepped,
            )
        )
        values.finish()
    check, condition = truths.blocks[0], truths.blocks[-1]
    return CheckCourse(
        duration_s=(end_ns - start_ns) / NS_PER_S,
        bin_s=values.width_ns / NS_PER_S,
        least=tuple(values.least),
        greatest=tuple(values.greatest),
        words=tuple(values.words),
        check=check,
        condition=condition,
        notices=(*map(folder.shown, outcome.notices), *_cut(truths)),
    )


def _draft(request: CheckCourseRequest) -> Draft:
    """The condition as rules of one file: the first is the check, the last the condition."""
    check = _check_in(request.condition)
    if is_source(check.topic):
        raise UsageError("no recording has it", place=check.topic, remedy="try it on a robot")
    conditions = [check] if request.condition is check else [check, request.condition]
    full = SetStatement(topic=check.topic, rate=FullRate())
    rules = [
        new_statement(RuleStatement(name="Check", condition=condition, then=(full,), otherwise=()))
        for condition in conditions
    ]
    empty = read_document("begin\nend\n", "check.adirf")
    text = inserted_all(empty, empty.parts[-1].id, 0, rules)
    return Draft(text=text, name="check.adirf", profile_text=request.profile_text)


def _cut(truths: TruthWatch) -> Iterator[str]:
    if truths.cut_s is not None:
        after = f"what holds after {grouped(truths.cut_s, 1)} s is left out"
        yield f"it turned more than {grouped(MAX_TURNS)} times; {after}"


class _ValueWatch:
    """The least and the greatest value of ``signal`` in each bin, as the evaluator is given it."""

    def __init__(self, signal: Signal, compared: Compared, start_ns: int, end_ns: int) -> None:
        self._signal = signal
        self._compared = compared
        self.words: list[tuple[float, str | None]] = []
        self._start_ns, self._end_ns = start_ns, end_ns
        self.width_ns = max(-(-(end_ns - start_ns) // MAX_BINS), 1)
        count = max(-(-(end_ns - start_ns) // self.width_ns), 1)
        self.least: list[float | None] = [None] * count
        self.greatest: list[float | None] = [None] * count
        self._loop: RelayLoop | None = None
        self._due_ns = start_ns
        self._bin = 0
        self._value: float | None = None

    def arrived(self, _channel: Channel, stamp_ns: int, _payload: bytes) -> None:
        """Time passed: a value may have aged, or be unknown by now."""
        if self._loop is not None and stamp_ns >= self._due_ns:
            self.stepped(stamp_ns, self._loop)

    def stepped(self, now_ns: int, loop: RelayLoop) -> None:
        """Read the value; it was that one in all bins since the last call."""
        self._loop = loop
        bin_ = max(min((now_ns - self._start_ns) // self.width_ns, len(self.least) - 1), 0)
        for held in range(self._bin, bin_ + 1):
            self._add(held, self._value)
        value = self._read(loop, now_ns)
        self._bin, self._value = bin_, value if isinstance(value, float) else None
        self._add(bin_, self._value)
        if isinstance(self._compared, str):
            self._turn(now_ns, None if value is None else value_words(value, self._compared))
        self._due_ns = self._start_ns + (bin_ + 1) * self.width_ns

    def _turn(self, now_ns: int, word: str | None) -> None:
        if (not self.words or self.words[-1][1] != word) and len(self.words) < MAX_TURNS:
            self.words.append((round((now_ns - self._start_ns) / NS_PER_S, 6), word))

    def _add(self, bin_: int, value: float | None) -> None:
        if value is None:
            return
        least, greatest = self.least[bin_], self.greatest[bin_]
        self.least[bin_] = value if least is None else min(least, value)
        self.greatest[bin_] = value if greatest is None else max(greatest, value)

    def finish(self) -> None:
        """The recording ended."""
        if self._loop is not None:
            self.stepped(self._end_ns, self._loop)

    def _read(self, loop: RelayLoop, now_ns: int) -> Value | None:
        knowledge = loop.knowledge
        readings = knowledge.readings(self._signal.topic, knowledge.time.at(now_ns))
        return shown_value(dict(readings)[self._signal])


def _signal_of(rule_set: RuleSet) -> Signal:
    return rule_set.written[0].checks[0].signal


def _check_in(condition: Condition) -> CheckCondition:
    while isinstance(condition, TimedCondition):
        condition = condition.term
    if not isinstance(condition, CheckCondition):
        raise UsageError("this is no check, nor a time of one", place="condition")
    return condition
