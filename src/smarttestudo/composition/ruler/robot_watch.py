# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The SmartTestudos of a ROS graph, watched on the thread that owns the node."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from smarttestudo.composition.ruler.rule_words import RuleWords, words_of
from smarttestudo.composition.ruler.status_demand import StatusDemand
from smarttestudo.composition.status_watch import HeardStatus, StatusWatch
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.remote_parameters import Refusals, Values
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.rule_texts import RuleTexts
from smarttestudo.domain.status import RuntimeStatus

TEXTS_PARAMETER = "rules_in_force"
HZ_PARAMETER = "status_hz"
_HEARD_WITHIN_S = 5.0
_FORGET_AFTER_S = 600.0
_ASK_AGAIN_S = 5.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenRobot:
    """The last status of a robot, when it came, its size, and the words of its rules as far as known."""

    status: RuntimeStatus
    heard_s: float
    size_bytes: int
    words: RuleWords

    def is_heard(self, now_s: float) -> bool:
        """Whether it spoke as lately as it should."""
        return now_s - self.heard_s <= _HEARD_WITHIN_S


class RobotWatch:
    """Hears the robots; of those that are watched, reads the rules and asks for more statuses.

    All calls are those of one thread, the one that waits in ``robot``.
    """

    def __init__(self, robot: Robot, steady_s: Callable[[], float]) -> None:
        self._robot = robot
        self._steady_s = steady_s
        self._watch = StatusWatch(robot, steady_s)
        self._wanted_hz: Mapping[str, float] = {}
        self._demands: dict[str, StatusDemand] = {}
        self._words: dict[str, RuleWords] = {}
        self._ask_again_s: dict[str, float] = {}
        self._seen: dict[str, SeenRobot] = {}

    def look(self) -> list[SeenRobot]:
        """The robots of which something new came since the last look."""
        now_s = self._steady_s()
        news = [self._see(node, heard) for node, heard in self._watch.heard.items() if self._is_new(heard)]
        for node in [node for node, one in self._seen.items() if now_s > one.heard_s + _FORGET_AFTER_S]:
            del self._watch.heard[node], self._seen[node]
            self._words.pop(node, None)
        for one in news:
            self._tend(one.status, now_s)
        return news

    @property
    def seen(self) -> Mapping[str, SeenRobot]:
        """All robots by node, as of the last look; a live view."""
        return self._seen

    def want(self, wanted_hz: Mapping[str, float]) -> None:
        """Watch these robots, so many times a second, and no others."""
        if wanted_hz == self._wanted_hz:
            return
        self._wanted_hz = dict(wanted_hz)
        for node in wanted_hz.keys() - self._demands.keys():
            self._demands[node] = StatusDemand()
        for node, demand in [*self._demands.items()]:
            demand.wanted_hz = wanted_hz.get(node)
            seen = self._seen.get(node)
            if seen is not None:
                self._tend(seen.status, self._steady_s())

    def _is_new(self, heard: HeardStatus) -> bool:
        seen = self._seen.get(heard.status.node)
        return seen is None or seen.status is not heard.status

    def _see(self, node: str, heard: HeardStatus) -> SeenRobot:
        words = self._words.get(node, RuleWords())
        if words.sha256 != heard.status.rules.sha256:
            words = RuleWords()
        seen = SeenRobot(status=heard.status, heard_s=heard.heard_s, size_bytes=heard.size_bytes, words=words)
        self._seen[node] = seen
        return seen

    def _tend(self, status: RuntimeStatus, now_s: float) -> None:
        demand = self._demands.get(status.node)
        if demand is None:
            return
        change_hz = demand.change_hz(status.status_hz, now_s)
        if change_hz is not None:
            self._robot.remote_parameters.set(status.node, {HZ_PARAMETER: change_hz}, _ignore)
        if demand.is_settled:
            del self._demands[status.node]
        if demand.wanted_hz is not None and status.rules.sha256:
            self._read_words(status, now_s)

    def _read_words(self, status: RuntimeStatus, now_s: float) -> None:
        known = self._words.get(status.node)
        is_known = known is not None and known.sha256 == status.rules.sha256
        if is_known or now_s < self._ask_again_s.get(status.node, 0.0):
            return
        self._ask_again_s[status.node] = now_s + _ASK_AGAIN_S
        got = partial(self._got_texts, status.node)
        self._robot.remote_parameters.get(status.node, [TEXTS_PARAMETER], got)

    def _got_texts(self, node: str, values: Values | RosError) -> None:
        if isinstance(values, RosError):
            return
        try:
            self._words[node] = words_of(RuleTexts.from_text(str(values[TEXTS_PARAMETER])))
        except ValueError:
            # A robot of an older version: states are told by their places alone.
            return
        self._ask_again_s.pop(node, None)


def _ignore(_refusals: Refusals | RosError) -> None:
    """An older robot has no such parameter, and one that is gone needs none."""
