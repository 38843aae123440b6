# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A feature beside the loop of a live run."""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from smarttestudo.domain.action import ActionDecision
from smarttestudo.domain.decision import AnyDecision
from smarttestudo.domain.link import IncomingCommands
from smarttestudo.domain.robot import Payload, Robot, Subscription
from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.loop.inputs import ChangeInput, WakeInput
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.loop.step import Trigger
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import AnyOption, Settings
from smarttestudo.robot.source import LiveSource

if TYPE_CHECKING:
    from smarttestudo.domain.link import OutgoingLink


class RunView(Protocol):
    """The run as its parts see it."""

    @property
    def rules(self) -> LiveRules:
        """The rules in force."""

    @property
    def loop(self) -> RelayLoop:
        """The loop."""

    def subscribed_here(self) -> Collection[str]:
        """The topics whose output has a subscriber on the robot's own graph."""

    def give(self, given: ChangeInput | WakeInput) -> None:
        """Give the loop a change or the time, and relay what comes of it."""

    def note(self, outcome: ActionDecision) -> None:
        """Have what came of an action stand beside the decisions."""


class Part:
    """All that a part may do; what it does not need does nothing.

    The run calls all methods on its own thread, and none of a part may stop the relays.
    """

    topics: frozenset[str] = frozenset()
    """The topics that are subscribed to because of it, relayed or not; read after ``on_wake`` too."""

    receives_topics_only: bool = False
    """Whether ``on_message`` needs to be called for ``topics`` only: others may be relayed without Python."""

    poll_s: float | None = None
    """How often ``poll`` is called, if it is."""

    needs_every_message: bool = False
    """Whether topics are received while nobody subscribes to what is relayed of them."""

    def running(self) -> AbstractContextManager[object]:
        """A context within which the run drives."""
        return nullcontext()

    def begin(self, run: RunView) -> None:
        """Begin with ``run``, once its loop is there."""

    def follow(self, rules: LiveRules, now_ns: int) -> None:
        """``rules`` are in force from ``now_ns`` on; the first time before ``begin``."""

    def on_source(self, topic: str, source: LiveSource, now_ns: int) -> None:
        """Messages of ``source`` are received from now on, if they were not before."""

    def on_message(
        self,
        topic: str,
        payload: Payload,
        publisher: Hashable,
        now_ns: int,
        subscription: Subscription | None,
    ) -> None:
        """A message was received by ``subscription`` at ``now_ns``, before the loop is given it.

        If its topic is relayed without Python, this is called up to a fifth of a second later, but before
        anything else that happened after it.
        """

    def on_trigger(self, trigger: Trigger) -> None:
        """A block with recordings began to hold, because of the last message or of the time."""

    def before_relays(self) -> None:
        """Messages are about to be published."""

    def before_publish(self, relayed: Relayed) -> None:
        """``relayed`` is about to be published; ``after_publish`` comes in any case."""

    def after_publish(self) -> None:
        """The message was published, or publishing it failed."""

    def on_graph(self) -> None:
        """The ROS graph was polled, which is done when it changes, and at times."""

    def poll(self) -> None:
        """``poll_s`` passed."""

    @property
    def wake_ns(self) -> int | None:
        """When, on the clock, to call ``on_wake`` at the latest."""
        return None

    def on_wake(self, now_ns: int) -> None:
        """Time passed."""

    def on_clock_jump(self, ahead_ns: int) -> None:
        """The clock jumped ahead by so much since the last call of any method: that time did not pass."""

    def on_decisions(self, decisions: Sequence[AnyDecision]) -> None:
        """Decisions were taken. If it raises, it gets no more."""

    def added_to(self, status: RuntimeStatus) -> RuntimeStatus:
        """``status`` with what the part adds."""
        return status

    def on_status(self, status: RuntimeStatus) -> None:
        """A status is complete and about to be published."""

    def finish(self) -> None:
        """The run is about to end; it goes on for as long as the part ``is_busy``."""

    @property
    def is_busy(self) -> bool:
        """Whether the run has to go on, some seconds at most, once it was told to ``finish``."""
        return False

    def close(self) -> None:
        """The run drives no more; its node is still there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PartContext:
    """All that a part is made of; ``resolve`` gives the full name of a topic on the robot.

    ``commands`` are what operators send over ``link``.
    """

    robot: Robot
    settings: Settings
    resolve: Callable[[str], str]
    link: OutgoingLink | None = None
    commands: IncomingCommands | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PartKind:
    """A feature that a run may have: its ``options``, and what makes it, if it is to be there.

    With a ``title``, the options stand apart in the help of the command line.
    """

    make: Callable[[PartContext], Part | None]
    options: tuple[AnyOption, ...] = ()
    title: str | None = None
