# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values of a robot's checks within the last hour and when its rules held, in bounded memory."""

from __future__ import annotations

import math
from array import array
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from threading import Lock
from typing import TypedDict

from msgspec import Struct

from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.ruler.robots.history import KEPT_S
from smarttestudo.ruler.robots.watch import Place, RobotCheck, SeenRobot, written_checks
from smarttestudo.ruler.rules.statement_trees import value_words
from smarttestudo.ruler.tries.watches import BlockTurns

BIN_S = 5.0
MAX_CHECKS = 100
MAX_TURNS_KEPT = 5000
MAX_WORDS_KEPT = 500
_BINS = int(KEPT_S / BIN_S)
_DIGITS = 3
_Key = tuple[str, Place]


class RobotChecksRequest(Struct, frozen=True, kw_only=True):
    """The last ``window_s`` of a robot, and the values of one check.

    ``check`` is its number in the answer; null asks for none.
    """

    node: str
    window_s: float
    check: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotCheckValues:
    """The least and the greatest value of check number ``check`` in bins of ``bin_s``, from ``first_bin_s``.

    Null where no status said a value. Of a check that compares with no number, ``words`` say what it read
    from when on. ``turns`` say what the check turned to when.
    """

    check: int
    bin_s: float
    first_bin_s: float
    least: tuple[float | None, ...]
    greatest: tuple[float | None, ...]
    words: tuple[tuple[float, str | None], ...]
    turns: tuple[tuple[float, Truth], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotChecksAnswer:
    """Rules and checks of a robot; times are since ``window_s`` ago, all is unknown before ``heard_from_s``.

    ``checks`` are at most 100, and none until the robot's rules were read.
    """

    window_s: float
    heard_from_s: float
    rules: tuple[BlockTurns, ...]
    checks: tuple[RobotCheck, ...]
    values: RobotCheckValues | None


class RobotChecks:
    """One robot's rules and checks since it got them; any thread may ask while another one adds."""

    def __init__(self) -> None:
        self._last: SeenRobot | None = None
        self._turns = _Turns(0.0)
        self._values: dict[_Key, _Bins] = {}
        self._words: dict[Place, _Words] = {}
        self._lock = Lock()

    def add(self, seen: SeenRobot) -> None:
        """Take a status; other rules than before begin anew."""
        with self._lock:
            last, now_s = self._last, seen.heard_s
            self._last = seen
            if last is None or last.status.rules.sha256 != seen.status.rules.sha256:
                self._turns, self._values, self._words, last = _Turns(now_s), {}, {}, None
            silent_from_s = now_s if last is None else last.heard_s + last.silent_after_s
            if silent_from_s < now_s:
                self._turns.silence(silent_from_s)
            for key, truth in _truths(seen.status):
                self._turns.add(now_s, key, truth)
            for key, value in _values(seen.status):
                if key not in self._values and len(self._values) < MAX_CHECKS:
                    self._values[key] = _Bins()
                if key in self._values:
                    number = None if isinstance(value, str) else value
                    self._values[key].add(now_s, number, held_until_s=silent_from_s)
            self._add_words(seen, silent_from_s)
            self._turns.forget(now_s - KEPT_S)

    def _add_words(self, seen: SeenRobot, silent_from_s: float) -> None:
        values = {place: value for (_, place), value in _values(seen.status)}
        for place, check in written_checks(seen):
            if check is None or not isinstance(check.limit, str):
                continue
            if place not in self._words and len(self._words) == MAX_CHECKS:
                continue
            value = values[place]
            words = self._words.setdefault(place, _Words())
            if silent_from_s < seen.heard_s:
                words.add(silent_from_s, None)
            words.add(seen.heard_s, None if value is None else value_words(value, check.limit))

    def answer(self, request: RobotChecksRequest, now_s: float) -> RobotChecksAnswer:
        """All that is known at ``now_s`` of the clock of the statuses."""
        window_s = min(max(request.window_s, BIN_S), KEPT_S)
        start_s = now_s - window_s
        with self._lock:
            last = self._last
            if last is None:
                return RobotChecksAnswer(
                    window_s=window_s, heard_from_s=window_s, rules=(), checks=(), values=None
                )
            silent_s = last.heard_s + last.silent_after_s
            turns = self._turns.since(start_s, silent_s if silent_s < now_s else None)
            known = ((place, check) for place, check in written_checks(last) if check is not None)
            checks = list(islice(known, MAX_CHECKS))
            values = None
            if request.check is not None and 0 <= request.check < len(checks):
                key = "check", checks[request.check][0]
                bins = self._values.get(key)
                until_s = silent_s if silent_s < now_s else None
                words = self._words.get(key[1])
                values = (
                    None
                    if bins is None
                    else RobotCheckValues(
                        check=request.check,
                        bin_s=BIN_S,
                        words=() if words is None else words.since(start_s, until_s),
                        turns=turns.get(key, ()),
                        **bins.told(start_s, now_s, held_until_s=silent_s),
                    )
                )
            heard_from_s = max(self._turns.from_s - start_s, 0.0)
        return RobotChecksAnswer(
            window_s=window_s,
            heard_from_s=heard_from_s,
            rules=tuple(
                BlockTurns(
                    rule=last.words.labels.get((block.file, block.line, block.column), f"line {block.line}"),
                    line=block.line,
                    turns=turns.get(("rule", (block.file, block.line, block.column)), ()),
                )
                for block in last.status.blocks
            ),
            checks=tuple(check for _, check in checks),
            values=values,
        )


class _Turns:
    """The newest turns of rules and checks; known from ``from_s`` on."""

    def __init__(self, from_s: float) -> None:
        self.from_s = from_s
        self._now: dict[_Key, Truth] = {}
        self._before: dict[_Key, Truth] = {}
        self._turns: deque[tuple[float, _Key, Truth]] = deque()

    def add(self, now_s: float, key: _Key, truth: Truth) -> None:
        if self._now.get(key) is truth:
            return
        self._now[key] = truth
        self._turns.append((now_s, key, truth))
        if len(self._turns) > MAX_TURNS_KEPT:
            self.from_s = self._forget_oldest()

    def silence(self, from_s: float) -> None:
        for key in self._now:
            self.add(from_s, key, Truth.UNKNOWN)

    def forget(self, before_s: float) -> None:
        self.from_s = max(self.from_s, before_s)
        while self._turns and self._turns[0][0] < before_s:
            self._forget_oldest()

    def _forget_oldest(self) -> float:
        turned_s, key, truth = self._turns.popleft()
        self._before[key] = truth
        return turned_s

    def since(self, start_s: float, silent_s: float | None) -> dict[_Key, tuple[tuple[float, Truth], ...]]:
        """The turns since ``start_s``, each the first one at 0; all are unknown from ``silent_s`` on."""
        first_s = max(self.from_s - start_s, 0.0)
        told: dict[_Key, list[tuple[float, Truth]]] = {}
        for key in self._now:
            told[key] = [(0.0, Truth.UNKNOWN)]
            _turn(told[key], first_s, self._before.get(key, Truth.UNKNOWN))
        for turned_s, key, truth in self._turns:
            _turn(told[key], max(turned_s - start_s, first_s), truth)
        if silent_s is not None:
            for turns in told.values():
                _turn(turns, max(silent_s - start_s, 0.0), Truth.UNKNOWN)
        return {
            key: tuple((round(turned_s, _DIGITS), truth) for turned_s, truth in turns)
            for key, turns in told.items()
        }


def _turn(turns: list[tuple[float, Truth]], turned_s: float, truth: Truth) -> None:
    """Add a turn; of those at one time the last one counts."""
    if turns[-1][0] >= turned_s:
        turned_s, _ = turns.pop()
    if not turns or turns[-1][1] is not truth:
        turns.append((turned_s, truth))


class _Words:
    """The words that a check read within the last hour, the newest 500 of them."""

    def __init__(self) -> None:
        self._turns: deque[tuple[float, str | None]] = deque(maxlen=MAX_WORDS_KEPT)

    def add(self, now_s: float, word: str | None) -> None:
        if not self._turns or self._turns[-1][1] != word:
            self._turns.append((now_s, word))

    def since(self, start_s: float, silent_s: float | None) -> tuple[tuple[float, str | None], ...]:
        """The words since ``start_s``, the first one at 0 or when it came; unknown from ``silent_s`` on."""
        turns = [*self._turns]
        if silent_s is not None and turns[-1][1] is not None:
            turns.append((silent_s, None))
        first = max((at for at, (turned_s, _) in enumerate(turns) if turned_s <= start_s), default=0)
        return tuple((round(max(turned_s - start_s, 0.0), _DIGITS), word) for turned_s, word in turns[first:])


class _BinsTold(TypedDict):
    first_bin_s: float
    least: tuple[float | None, ...]
    greatest: tuple[float | None, ...]


class _Bins:
    """The least and the greatest value in bins of ``BIN_S`` over the last hour."""

    def __init__(self) -> None:
        self._least = array("d", [math.nan] * _BINS)
        self._greatest = array("d", [math.nan] * _BINS)
        self._newest = 0
        self._value = math.nan

    def add(self, now_s: float, value: float | None, *, held_until_s: float) -> None:
        """Take a value; the one before held until it came, or until ``held_until_s``."""
        bin_ = int(now_s // BIN_S)
        held_until = int(held_until_s // BIN_S)
        for passed in range(max(self._newest + 1, bin_ - _BINS + 1), bin_ + 1):
            held = self._value if passed <= held_until else math.nan
            self._least[passed % _BINS] = self._greatest[passed % _BINS] = held
        self._newest = bin_
        self._value = value if value is not None and math.isfinite(value) else math.nan
        if math.isnan(self._value):
            return
        at = bin_ % _BINS
        # NaN, which stands for none yet, compares false.
        if not self._least[at] <= self._value:
            self._least[at] = self._value
        if not self._greatest[at] >= self._value:
            self._greatest[at] = self._value

    def told(self, start_s: float, now_s: float, *, held_until_s: float) -> _BinsTold:
        """The values from ``start_s`` until now; the last one is held until ``held_until_s``."""
        held_until = int(held_until_s // BIN_S)
        first, last = int(start_s // BIN_S), int(now_s // BIN_S)
        kept = range(max(first, last - _BINS + 1), last + 1)
        return _BinsTold(
            first_bin_s=kept[0] * BIN_S - start_s,
            least=tuple(self._told(self._least, bin_, held_until) for bin_ in kept),
            greatest=tuple(self._told(self._greatest, bin_, held_until) for bin_ in kept),
        )

    def _told(self, bins: array[float], bin_: int, held_until: int) -> float | None:
        if bin_ > self._newest:
            value = self._value if bin_ <= held_until else math.nan
        else:
            value = bins[bin_ % _BINS] if bin_ > self._newest - _BINS else math.nan
        return None if math.isnan(value) else value


def _truths(status: RuntimeStatus) -> Iterator[tuple[_Key, Truth]]:
    for block in status.blocks:
        yield ("rule", (block.file, block.line, block.column)), block.state
        for check in block.checks:
            yield ("check", (block.file, check.line, check.column)), check.state


def _values(status: RuntimeStatus) -> Iterator[tuple[_Key, float | str | None]]:
    for block in status.blocks:
        for check in block.checks:
            yield ("check", (block.file, check.line, check.column)), check.value
