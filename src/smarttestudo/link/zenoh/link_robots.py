# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The robots that are heard over links, from a machine that needs no ROS."""

from __future__ import annotations

import queue
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TypeVar

from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.parameter import (
    GetParameters,
    GetTopics,
    Got,
    Question,
    SetParameters,
    SilentNodeError,
    Values,
    WasSet,
)
from smarttestudo.domain.remote_robots import ANSWER_WITHIN_S, GotTopics, HeardStatus
from smarttestudo.domain.status import RuntimeStatus, status_from_json
from smarttestudo.link.protocol.keys import MAX_ROBOTS, Boot
from smarttestudo.link.protocol.messages import (
    ANSWERS,
    CHANGING_QUESTIONS,
    MAX_QUESTION_BYTES,
    READING_QUESTIONS,
)
from smarttestudo.link.protocol.status_stream import Record
from smarttestudo.link.protocol.wire import malformed
from smarttestudo.link.zenoh.compression import sendable, unpacked
from smarttestudo.link.zenoh.link_client import LinkClient, LinkClients
from smarttestudo.link.zenoh.queries import Reply

_MOST_WAITING = 10_000
_SIZES = 10
_DIGITS_OF_BOOT = 4
_NO_WAIT = 0.5
"""The share of the time for an answer in which Zenoh says that nobody is there to answer."""
_Read = TypeVar("_Read")


@dataclass(slots=True, eq=False)
class _Robot:
    """A run of a robot's end, and what was heard of it last."""

    boot: Boot
    is_present: bool = True
    status: RuntimeStatus | None = None
    heard_s: float = 0.0
    sizes: deque[int] = field(default_factory=lambda: deque(maxlen=_SIZES))


class LinkRobots:
    """The robots that ``client`` reaches, as ``RemoteRobots``; what comes waits until ``wait``."""

    def __init__(self, client: LinkClient | LinkClients, place: str, steady_s: Callable[[], float]) -> None:
        self.place = place
        self.unreadable = 0
        self._client = client
        self._steady_s = steady_s
        self._inbox: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._robots: dict[Boot, _Robot] = {}
        self.heard: Mapping[str, HeardStatus] = {}
        """The last status of each robot, those of one name apart by a number after it."""
        self._boots: Mapping[str, Boot] = {}
        self._knows_all = False
        client.begin(
            on_status=lambda *said: self._later(partial(self._on_status, *said)),
            on_presence=lambda *said: self._later(partial(self._on_presence, *said)),
            all_known=lambda: self._later(self._know_all),
        )

    @property
    def has_heard_all(self) -> bool:
        """Whether a status of each robot that is there was received, and there is one."""
        present = [robot for robot in self._robots.values() if robot.is_present]
        return self._knows_all and bool(present) and all(robot.status for robot in present)

    @property
    def remedy(self) -> str:
        """Advice where none is heard: about admission, where somebody is there and refuses it."""
        if self._client.is_refused:
            return "check certificates, user and password in --zenoh-config, here and there"
        return "start `testudo run --link` on the robot, and check that it reaches the same place"

    @property
    def problem(self) -> str | None:
        return self._client.problem

    def wait(self, timeout_s: float) -> None:
        """Receive what comes, for so long at most."""
        try:
            self._inbox.get(timeout=timeout_s)()
            while True:
                self._inbox.get_nowait()()
        except queue.Empty:
            return

    def forget(self, robot_id: str) -> None:
        """Let go of what was heard of a robot."""
        boot = self._boots.get(robot_id)
        if boot is not None:
            self._drop_gone(boot.robot)
            self._name()

    def get(self, robot_id: str, names: Sequence[str], got: Got) -> None:
        """The values of parameters; one that the robot does not have is ``None``."""
        self._ask(robot_id, GetParameters(names=tuple(names)), ANSWERS.from_bytes, got)

    def set(self, robot_id: str, values: Values, was_set: WasSet) -> None:
        """Have a robot give its parameters these values, each by itself."""
        self._ask(robot_id, SetParameters(values=values), _texts, was_set)

    def topics(self, robot_id: str | None, got: GotTopics) -> None:
        """The topics that the own nodes of a robot publish, or of all that are there."""
        if robot_id is not None:
            self._ask(robot_id, GetTopics(), _texts, got)
            return
        asked = [name for name, heard in self.heard.items() if heard.is_present]
        answers: list[Mapping[str, str]] = []

        def collect(answer: Mapping[str, str] | TestudoError) -> None:
            # A robot that does not answer has none to suggest.
            answers.append({} if isinstance(answer, TestudoError) else answer)
            if len(answers) == len(asked):
                got({topic: type_name for one in answers for topic, type_name in one.items()})

        for name in asked:
            self._ask(name, GetTopics(), _texts, collect)
        if not asked:
            self._later(lambda: got({}))

    def _ask(
        self,
        robot_id: str,
        question: Question,
        read: Callable[[bytes], _Read],
        on_answer: Callable[[_Read | TestudoError], None],
    ) -> None:
        boot = self._boots.get(robot_id)
        asked_s = self._steady_s()

        def answered(reply: Reply) -> None:
            answer: _Read | TestudoError
            try:
                if isinstance(reply, bytes):
                    answer = read(unpacked(reply, MAX_QUESTION_BYTES))
                else:
                    answer = reply or self._silent(robot_id, asked_s)
            except LinkError as error:
                answer = error
            on_answer(answer)

        if boot is None:
            self._later(lambda: on_answer(self._silent(robot_id, asked_s)))
            return
        later = partial(self._answer_later, answered)
        try:
            if isinstance(question, SetParameters):
                self._client.get(boot.set_key, sendable(CHANGING_QUESTIONS.to_bytes(question)), later)
            else:
                self._client.get(boot.get_key, sendable(READING_QUESTIONS.to_bytes(question)), later)
        except LinkError as error:
            later(error)

    def _answer_later(self, answered: Callable[[Reply], None], reply: Reply) -> None:
        self._later(partial(answered, reply))

    def _silent(self, robot_id: str, asked_s: float) -> SilentNodeError:
        has_waited = self._steady_s() - asked_s > _NO_WAIT * ANSWER_WITHIN_S
        return SilentNodeError(
            f"the robot did not answer within {ANSWER_WITHIN_S:g} s"
            if has_waited
            else "nobody takes this there",
            place=robot_id,
            remedy="check that `testudo run` is still running, and that access control lets you ask this",
        )

    def _later(self, act: Callable[[], None]) -> None:
        if self._inbox.qsize() < _MOST_WAITING:
            self._inbox.put(act)

    def _know_all(self) -> None:
        self._knows_all = True

    def _on_presence(self, boot: Boot, is_present: bool) -> None:  # noqa: FBT001 - what a client calls
        if boot in self._robots:
            self._robots[boot].is_present = is_present
        elif is_present:
            self._drop_gone(boot.robot)
            if len(self._robots) < MAX_ROBOTS:
                self._robots[boot] = _Robot(boot)
        self._name()

    def _drop_gone(self, name: str) -> None:
        """Let go of the runs of a robot that are over."""
        gone = [boot for boot, robot in self._robots.items() if boot.robot == name and not robot.is_present]
        for boot in gone:
            del self._robots[boot]

    def _on_status(self, boot: Boot, record: Record, size_bytes: int) -> None:
        robot = self._robots.get(boot)
        if robot is None:
            return
        try:
            # Who may be heard as whom is a matter of keys.
            robot.status = replace(status_from_json(record), robot=boot.robot)
        except ValueError:
            self.unreadable += 1
            return
        robot.heard_s = self._steady_s()
        robot.sizes.append(size_bytes)
        self._name()

    def _name(self) -> None:
        """Have each robot under an id of its own; one that is gone gives way to a newer run of its own."""
        known = [(robot, robot.status) for robot in self._robots.values() if robot.status is not None]
        present = Counter(status.robot_id for robot, status in known if robot.is_present)
        heard, boots = {}, {}
        for robot, status in sorted(known, key=lambda one: (one[0].is_present, one[0].heard_s)):
            if robot.is_present and present[status.robot_id] > 1:
                number = robot.boot.number[:_DIGITS_OF_BOOT]
                status = replace(status, robot=f"{status.robot}#{number}")  # noqa: PLW2901
            elif not robot.is_present and present[status.robot_id]:
                continue
            boots[status.robot_id] = robot.boot
            heard[status.robot_id] = HeardStatus(
                status=status,
                heard_s=robot.heard_s,
                size_bytes=round(sum(robot.sizes) / max(len(robot.sizes), 1)),
                is_present=robot.is_present,
            )
        self.heard, self._boots = heard, boots


def _texts(data: bytes) -> Mapping[str, str]:
    """An answer with a text to each name."""
    answer = ANSWERS.from_bytes(data)
    if not all(isinstance(value, str) for value in answer.values()):
        raise malformed("an answer without texts")
    return {name: str(value) for name, value in answer.items()}
