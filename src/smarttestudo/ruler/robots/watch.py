# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that can be heard, or were, watched on one thread."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.parameter import Refusals, Values
from smarttestudo.domain.remote_robots import HeardStatus, RemoteRobots, RuleTexts
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.language.parser import parse
from smarttestudo.language.syntax import Block, Operator
from smarttestudo.language.syntax_walks import checks_in
from smarttestudo.ruler.robots.known import latest
from smarttestudo.ruler.rules.statement_trees import page_value
from smarttestudo.ruler.rules.statements import Compared

Place = tuple[int, int, int]
"""A file's number, line and column."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotCheck:
    """A check of the robot's rules, in the words of its text, and the rule that it is in.

    What it says of a value does not depend on its place, so the words find it in another text.
    """

    rule: str
    topic: str
    property: str
    op: Operator
    limit: Compared


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleWords:
    """The names of blocks and the words of checks by their places in the texts with ``sha256``."""

    sha256: str = ""
    labels: Mapping[Place, str] = field(default_factory=dict)
    checks: Mapping[Place, RobotCheck] = field(default_factory=dict)
    full_names: Mapping[str, str] = field(default_factory=dict)


def words_of(texts: RuleTexts) -> RuleWords:
    """The words of all blocks in ``texts``."""
    labels: dict[Place, str] = {}
    checks: dict[Place, RobotCheck] = {}
    for number, (name, text) in enumerate(texts.files):
        for statement in parse(text, name).file.statements:
            if isinstance(statement, Block):
                labels[number, statement.span.line, statement.span.column] = statement.label
                for check in checks_in(statement.condition):
                    checks[number, check.span.line, check.span.column] = RobotCheck(
                        rule=statement.label,
                        topic=check.topic.text,
                        property=check.property,
                        op=check.operator,
                        limit=page_value(check.value),
                    )
    return RuleWords(sha256=texts.sha256, labels=labels, checks=checks, full_names=texts.full_names)


_TRY_AGAIN_S = 3.0


class StatusRateRequest:
    """Request for the ``status_hz`` of one robot.

    Others may set it, too: it is never set lower than before.
    """

    def __init__(self) -> None:
        self.wanted_hz: float | None = None
        self._ours_hz: float | None = None
        self._before_hz = 0.0
        self._again_s = 0.0

    @property
    def is_settled(self) -> bool:
        """Whether no page watches, and nothing is to be restored."""
        return self.wanted_hz is None and self._ours_hz is None

    def change_hz(self, status_hz: float, now_s: float) -> float | None:
        """Rate to set at ``now_s``, where the robot said that it is ``status_hz``; ``None``: nothing."""
        if self.wanted_hz is None:
            return self._put_back_hz(status_hz, now_s)
        is_ours = status_hz == self._ours_hz
        if status_hz >= self.wanted_hz and not (is_ours and status_hz > self.wanted_hz):
            return None
        if self.wanted_hz == self._ours_hz and now_s < self._again_s:
            return None
        if self._ours_hz is None:
            self._before_hz = status_hz
        self._ours_hz, self._again_s = self.wanted_hz, now_s + _TRY_AGAIN_S
        return self.wanted_hz

    def _put_back_hz(self, status_hz: float, now_s: float) -> float | None:
        ours_hz, self._ours_hz = self._ours_hz, None
        # What was set a moment ago is not in a status yet.
        is_ours = ours_hz is not None and (status_hz == ours_hz or now_s < self._again_s)
        return self._before_hz if is_ours else None


TEXTS_PARAMETER = "rules_in_force"
HZ_PARAMETER = "status_hz"
_HEARD_WITHIN_S = 2.4
_ASK_AGAIN_S = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenRobot(HeardStatus):
    """The last status of a robot, with the words of its rules as far as they are known."""

    words: RuleWords

    @property
    def silent_after_s(self) -> float:
        """How long after this status the next one should be there."""
        return _HEARD_WITHIN_S * max(1.0, 1.0 / self.status.status_hz)

    def is_heard(self, now_s: float) -> bool:
        """Whether it spoke as lately as it should."""
        return self.is_present and now_s - self.heard_s <= self.silent_after_s

    def silent_s(self, now_s: float) -> float | None:
        """For how long it is silent; ``None`` while it is heard."""
        return None if self.is_heard(now_s) else max(now_s - self.heard_s, 0.0)


def seen_robot(heard: HeardStatus, words: RuleWords) -> SeenRobot:
    """A status that was heard, with the words of its rules."""
    return SeenRobot(
        status=heard.status,
        heard_s=heard.heard_s,
        size_bytes=heard.size_bytes,
        is_present=heard.is_present,
        words=words,
    )


def written_checks(seen: SeenRobot) -> Iterator[tuple[Place, RobotCheck | None]]:
    """The checks of a status by their places; ``None`` for those whose words are not known."""
    for block in seen.status.blocks:
        for check in block.checks:
            place = block.file, check.line, check.column
            yield place, seen.words.checks.get(place)


class RobotWatch:
    """Hears the robots; of those that are watched, reads the rules and asks for more statuses.

    All calls are those of one thread, the one that waits in ``robots``. Robots are told by their ids.
    """

    def __init__(
        self,
        robots: RemoteRobots,
        steady_s: Callable[[], float],
        known: Mapping[str, HeardStatus] = MappingProxyType({}),
    ) -> None:
        self._robots = robots
        self._steady_s = steady_s
        self._wanted_hz: Mapping[str, float] = {}
        self._demands: dict[str, StatusRateRequest] = {}
        self._words: dict[str, RuleWords] = {}
        self._ask_again_s: dict[str, float] = {}
        self._seen: dict[str, SeenRobot] = {}
        self._not_heard = set(known)
        for name, one in known.items():
            self._see(name, one)

    def poll(self) -> list[SeenRobot]:
        """The robots of which something new came since the last poll."""
        now_s = self._steady_s()
        heard = dict(self._robots.heard)
        news = [self._see(name, one) for name, one in heard.items() if self._is_new(name, one)]
        self._not_heard -= heard.keys()
        # The robots of one name are told apart, and called otherwise once one of them is gone.
        for name in self._seen.keys() - heard.keys() - self._not_heard:
            self._forget(name)
        for name in self._seen.keys() - {one.status.robot_id for one in latest(self._seen.values())}:
            self.remove(name)
        for one in news:
            self._tend(one.status, now_s)
        return news

    @property
    def seen(self) -> Mapping[str, SeenRobot]:
        """All robots by their ids, as of the last poll; a live view."""
        return self._seen

    def remove(self, name: str) -> None:
        """Know a robot no more, until it is heard again."""
        self._robots.forget(name)
        self._forget(name)

    def _forget(self, name: str) -> None:
        self._not_heard.discard(name)
        self._seen.pop(name, None)
        self._words.pop(name, None)

    def want(self, wanted_hz: Mapping[str, float]) -> None:
        """Watch these robots, so many times a second, and no others."""
        if wanted_hz == self._wanted_hz:
            return
        self._wanted_hz = dict(wanted_hz)
        for node in wanted_hz.keys() - self._demands.keys():
            self._demands[node] = StatusRateRequest()
        for node, demand in [*self._demands.items()]:
            demand.wanted_hz = wanted_hz.get(node)
            seen = self._seen.get(node)
            if seen is not None:
                self._tend(seen.status, self._steady_s())

    def _is_new(self, name: str, heard: HeardStatus) -> bool:
        seen = self._seen.get(name)
        return seen is None or (seen.heard_s, seen.is_present) != (heard.heard_s, heard.is_present)

    def _see(self, node: str, heard: HeardStatus) -> SeenRobot:
        words = self._words.get(node, RuleWords())
        if words.sha256 != heard.status.rules.sha256:
            words = RuleWords()
        seen = seen_robot(heard, words)
        self._seen[node] = seen
        return seen

    def _tend(self, status: RuntimeStatus, now_s: float) -> None:
        demand = self._demands.get(status.robot_id)
        if demand is None:
            return
        change_hz = demand.change_hz(status.status_hz, now_s)
        if change_hz is not None:
            self._robots.set(status.robot_id, {HZ_PARAMETER: change_hz}, _ignore)
        if demand.is_settled:
            del self._demands[status.robot_id]
        if demand.wanted_hz is not None and status.rules.sha256:
            self._read_words(status, now_s)

    def _read_words(self, status: RuntimeStatus, now_s: float) -> None:
        known = self._words.get(status.robot_id)
        is_known = known is not None and known.sha256 == status.rules.sha256
        if is_known or now_s < self._ask_again_s.get(status.robot_id, 0.0):
            return
        self._ask_again_s[status.robot_id] = now_s + _ASK_AGAIN_S
        got = partial(self._got_texts, status.robot_id)
        self._robots.get(status.robot_id, [TEXTS_PARAMETER], got)

    def _got_texts(self, node: str, values: Values | TestudoError) -> None:
        if isinstance(values, TestudoError):
            return
        try:
            self._words[node] = words_of(RuleTexts.from_text(str(values[TEXTS_PARAMETER])))
        except ValueError:
            # A robot of an older version: states have positions only.
            return
        self._ask_again_s.pop(node, None)


def _ignore(_refusals: Refusals | TestudoError) -> None:
    """An older robot has no such parameter, and one that is gone needs none."""
