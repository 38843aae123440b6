# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One topic of a robot while it runs: its source, its publishers, the relay between them, and its figures."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence, Set
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace

from smarttestudo.domain.compiled_relay import CompiledRelay, MessageCopy
from smarttestudo.domain.errors import TestudoError, error_at
from smarttestudo.domain.names import require_publishable
from smarttestudo.domain.observation import Undecodable
from smarttestudo.domain.rate_meter import Flow
from smarttestudo.domain.robot import Endpoint, Payload, Publisher, Robot, Subscription
from smarttestudo.domain.texts import SayOnce
from smarttestudo.loop.statistics import RelayStatistics
from smarttestudo.robot.gone_publishers import GonePublishers
from smarttestudo.robot.losses import TopicLosses
from smarttestudo.robot.sampling import SampledTopic
from smarttestudo.robot.source import LiveSource, not_offered, suits
from smarttestudo.robot.status import MeasuredTopic, TopicLink, TopicMeters

MAX_PUBLISHERS = 64


class PublisherPool:
    """One publisher for all, or with ``one_each`` one for each publisher of the source.

    The latter is for latched topics: a publisher keeps the last messages only, so that a source's publisher
    that sends often would push out the single message of another one. Where a link keeps only the newest
    message, it is so for every topic. All calls may raise what the middleware does.
    """

    def __init__(self, advertise: Callable[[], Publisher], *, one_each: bool) -> None:
        self._advertise = advertise
        self._one_each = one_each
        self._of: dict[Hashable, Publisher] = {}
        self._gone = GonePublishers()
        # One is there before the first message, so that subscribers find it in time.
        self._spare: Publisher | None = advertise()

    def publish(self, payload: Payload, publisher: Hashable) -> None:
        """Send a message of ``publisher``."""
        key = publisher if self._one_each else None
        open_publisher = self._of.get(key)
        if open_publisher is None:
            open_publisher = self._open(key)
        open_publisher.publish(payload)

    @property
    def only(self) -> Publisher | None:
        """The publisher of all messages; ``None`` with one for each publisher of the source."""
        if self._one_each:
            return None
        return self._of.get(None) or self._open(None)

    def forget_undiscovered(
        self, known: Set[Hashable], found: Callable[[], Set[Hashable]], now_ns: int
    ) -> None:
        """Forget those of which something was received, and which were gone before the graph was polled.

        ``known`` are forgotten when they go. ``found``, which costs more, are those that are there now; where
        there are none, the last one stays.
        """
        if not self._one_each or self._of.keys() <= known:
            return
        there = found()
        opened = tuple(self._of)
        self.forget(self._gone.among(opened, known | there, now_ns, is_somebody_there=bool(there)))

    def forget(self, publishers: Iterable[Hashable]) -> None:
        """These are gone, and what they latched goes with them."""
        gone = [self._of.pop(publisher) for publisher in publishers if publisher in self._of]
        if gone and not self._of and self._spare is None:
            self._spare = self._advertise()
        _close(gone)

    def close(self) -> None:
        """Send nothing more."""
        _close([one for one in (*self._of.values(), self._spare) if one is not None])

    def _open(self, key: Hashable) -> Publisher:
        if len(self._of) >= MAX_PUBLISHERS:
            key = None
        if key not in self._of:
            self._of[key] = self._spare or self._advertise()
            self._spare = None
        return self._of[key]


def _close(publishers: Sequence[Publisher]) -> None:
    """Close all, though one fails."""
    with ExitStack() as closing:
        for one in publishers:
            closing.callback(one.close)


OnProblem = Callable[[TestudoError | None], None]
"""Takes what failed for a topic, or nothing where it works again."""
OnMessage = Callable[["Topic", Payload | None, Hashable, MessageCopy | None], None]
"""Takes a message: its topic, payload and publisher where that is known, and the copy that it is, if any."""
Ends = tuple[Subscription, Publisher | None]
"""Where all messages of a topic come in and go out."""
# What is recorded is recorded whole, bursts too.
RECORDED_SUBSCRIPTION_DEPTH = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class RelayUse:
    """How a topic is relayed without Python: by which publisher, and why its messages are copied."""

    publisher: Publisher | None
    is_relayed: bool
    is_recorded: bool
    is_counted: bool

    @property
    def copies_all(self) -> bool:
        return self.is_recorded or self.is_counted


class Topic:
    """One topic of a live run: what is open for it, and all that the run knows of it beside the loop.

    ``output`` is its output topic, ``None`` if it is not relayed; a check reads it where it ``is_watched``,
    and a part where it ``is_recorded``, so that more of its messages may wait. ``publishers`` are those of
    its source, ``subscribers`` those of its output, as of the last poll of the graph; ``listeners`` are the
    GIDs of the latter that the loop knows. ``has_header`` is whether its messages begin with a
    std_msgs/Header. Messages of ``ignored`` publishers are dropped. Unless its source ``is_reported``, the
    loop does not know it. ``subscriptions`` counts how often it was subscribed to.

    Its messages are received by Python, all or as it is ``sampled``, or a ``compiled`` relay takes and paces
    them for a ``use``; ``is_left`` says whether it was last to be relayed so. ``unrelayed`` counts what is
    received and not relayed.

    Nothing here raises: whatever fails in the middleware, or where a message goes, costs this topic only. It
    is its ``problem``, which ``on_problem`` gets. What could not be opened is tried again when the source
    or the need for it changes.
    """

    def __init__(self, name: str, robot: Robot, on_message: OnMessage, *, on_problem: OnProblem) -> None:
        self.name = name
        self.output: str | None = None
        self.is_watched = False
        self.is_recorded = False
        self.source: LiveSource | None = None
        self.publishers: Sequence[Endpoint] = ()
        self.subscribers: Sequence[Endpoint] = ()
        self.listeners: frozenset[bytes] | None = None
        self.has_header = False
        self.ignored: frozenset[Hashable] = frozenset()
        self.is_wanted = False
        self.is_reported = True
        self.problem: str | None = None
        self.priority = 1.0
        self.subscription: Subscription | None = None
        self.subscriptions = 0
        self.losses = TopicLosses(name, robot.log.warning, lambda: self.publishers, robot.senders_remedy)
        self.sampled: SampledTopic | None = None
        self.compiled: CompiledRelay | None = None
        self.use: RelayUse | None = None
        self.is_left = False
        self.unrelayed: Flow | None = None
        self.meters: TopicMeters | None = None
        self._path = robot.data_path
        self._warn_once = SayOnce(robot.log.warning)
        self._on_message = on_message
        self._on_problem = on_problem
        self._is_refused = False
        self._opened_for: LiveSource | None = None
        self._publishers: PublisherPool | None = None

    @property
    def is_given(self) -> bool:
        """Whether the loop is given its messages."""
        return self.output is not None or self.is_watched

    def follow(self, source: LiveSource, refusal: TestudoError | None = None) -> None:
        """Open what ``source`` needs, anew where what is open does not suit; nothing with a ``refusal``."""
        before, self.source = self.source, source
        was_refused, self._is_refused = self._is_refused, refusal is not None
        if refusal is not None:
            if not was_refused:
                self.close()
                self.fail(refusal)
            return
        if self._opened_for is None or not suits(self._opened_for, source):
            self._open()
        elif before is not None and self._publishers is not None and source.publishers:
            with self._costing():
                self._publishers.forget(before.gids - source.gids)

    def forget_undiscovered(self, found: Callable[[], Sequence[Endpoint]], now_ns: int) -> None:
        """Drop what publishers latched that came and went between two polls.

        ``found`` gives the publishers that are there now.
        """
        # Before the first session of a link, what waits for it would go with its publisher.
        if self._publishers is not None and self.source is not None and not self._path.keeps_newest:
            known = self.source.gids
            with self._costing():
                self._publishers.forget_undiscovered(known, lambda: {one.gid for one in found()}, now_ns)

    def note_header(self, begins_with_header: Callable[[str], bool]) -> None:
        """See whether its messages begin with one."""
        if self.source is not None:
            with self._costing():
                self.has_header = begins_with_header(self.source.type_name)

    def want(self, *, is_wanted: bool) -> bool:
        """Subscribe, or do so no longer; whether that is a change."""
        if is_wanted == self.is_wanted:
            return False
        self.is_wanted = is_wanted
        if self._opened_for is None:
            if is_wanted and self.source is not None and not self._is_refused:
                self._open()
            return self._opened_for is not None
        if is_wanted:
            with self._costing(closes=True):
                self._subscribe(self._opened_for)
        elif self.is_latched:
            # What is latched comes anew with the next subscription, and must not be there twice.
            self._open()
        else:
            self._unsubscribe()
        return True

    @property
    def is_latched(self) -> bool:
        """Whether it is open for a source that keeps its last messages for late subscribers."""
        return self._opened_for is not None and self._opened_for.qos.transient_local

    def serve(self, output: str | None, *, is_recorded: bool) -> None:
        """Have another output topic, or none; by the same subscription if it ``is_recorded`` and was before.

        What is latched must come anew for another output; nobody misses what is not recorded meanwhile.
        """
        self.output = output
        if not (self.is_recorded and is_recorded) or self.is_latched:
            self.close()
            self.source, self.problem, self.is_wanted, self._is_refused = None, None, False, False
            return
        self._close_publishers()
        if output is not None and self._opened_for is not None:
            with self._costing(closes=True):
                self._publishers = self._publishers_to(output, self._opened_for)

    def receive(self, payload: Payload | None, publisher: Hashable, copy: MessageCopy | None = None) -> None:
        """Take a message of its source, which its subscription or its compiled relay took."""
        if publisher in self.ignored:
            return
        try:
            self._on_message(self, payload, publisher, copy)
        except Exception as error:  # noqa: BLE001 - see the class
            self.fail(error)

    def decoded(self, payload: Payload) -> object:
        """The message of a payload, or ``Undecodable``."""
        assert self.source is not None
        try:
            return self._path.decode(self.name, self.source.type_name, payload)
        except Exception:  # noqa: BLE001 - whatever it fails of, the message is what is not known
            self._warn_once(f"{self.name}: a message could not be decoded; what checks read is unknown then")
            return Undecodable()

    def publish(self, payload: Payload, publisher: Hashable) -> None:
        """Send a message on the output topic."""
        if self._publishers is None:
            return
        try:
            self._publishers.publish(payload, publisher)
        except Exception as error:  # noqa: BLE001 - see the class
            self.fail(error)
        else:
            if self.problem is not None:
                self._set_problem(None)

    def fail(self, error: Exception) -> None:
        """Note what failed for this topic."""
        self._set_problem(error_at(self.name, error))

    def ends(self, *, is_published: bool) -> Ends | None:
        """Where all messages come in and go out, if there is one place for each, and none is dropped.

        Unless it ``is_published``, nothing goes out there; what is latched has no such ends then. What is
        only watched has none.
        """
        if self.subscription is None or self.ignored or (self.is_watched and self.output is None):
            return None
        if self._publishers is None or not is_published:
            return None if self.is_latched else (self.subscription, None)
        publisher = self._publishers.only
        return None if publisher is None else (self.subscription, publisher)

    @property
    def may_pause(self) -> bool:
        """Whether only some messages may be received: not where it is recorded, or has two publishers."""
        return self.subscription is not None and not self.is_recorded and len(self.publishers) <= 1

    def measured(self, statistics: RelayStatistics) -> MeasuredTopic:
        """The topic as its status sees it; new rules may come with new ``statistics``."""
        if self.meters is None or self.meters.statistics is not statistics:
            self.meters = TopicMeters(statistics)
        return MeasuredTopic(self.link(), self.meters, self.losses.loss())

    def link(self) -> TopicLink:
        """Its connections; it is relayed."""
        assert self.output is not None
        link = TopicLink(
            output=self.output,
            is_subscribed=self.subscription is not None,
            subscriptions=self.subscriptions,
            subscribers=len(self.subscribers),
            problem=self.problem,
        )
        source = self.source
        if source is None:
            return link
        unserved = [one for one in self.subscribers if not_offered(source.qos, one)]
        return replace(
            link,
            type_name=source.type_name,
            publishers=source.publishers,
            transient_local=source.qos.transient_local,
            has_header=self.has_header,
            unserved=len(unserved),
            incompatible=tuple(sorted({one.node for one in unserved})),
        )

    def close(self) -> None:
        """Receive and send nothing more."""
        self._opened_for = None
        self._unsubscribe()
        self._close_publishers()

    def _open(self) -> None:
        self.close()
        source = self.source
        assert source is not None
        with self._costing(closes=True):
            if self.output is not None:
                self._publishers = self._publishers_to(self.output, source)
            if self.is_wanted:
                self._subscribe(source)
            self._opened_for, self.problem = source, None

    @contextmanager
    def _costing(self, *, closes: bool = False) -> Iterator[None]:
        """Have whatever the block raises cost this topic, which then is closed where it ``closes``."""
        try:
            yield
        except Exception as error:  # noqa: BLE001 - see the class
            if closes:
                self.close()
            self.fail(error)

    def _set_problem(self, error: TestudoError | None) -> None:
        problem = None if error is None else error.cause
        if problem != self.problem:
            self.problem = problem
            self._on_problem(error)

    def _publishers_to(self, output: str, source: LiveSource) -> PublisherPool:
        require_publishable(output, self.name)
        return PublisherPool(
            lambda: self._path.advertise(output, source.type_name, source.qos),
            one_each=self._path.identifies_publishers
            and (source.qos.transient_local or self._path.keeps_newest),
        )

    def _subscribe(self, source: LiveSource) -> None:
        qos = source.subscription_qos
        if self.is_recorded:
            qos = replace(qos, depth=max(RECORDED_SUBSCRIPTION_DEPTH, qos.depth))
        self.subscription = self._path.subscribe(
            self.name, source.type_name, qos, self.receive, priority=self.priority
        )
        self.subscriptions += 1

    def _unsubscribe(self) -> None:
        subscription, self.subscription = self.subscription, None
        if subscription is not None:
            with self._costing():
                subscription.close()

    def _close_publishers(self) -> None:
        publishers, self._publishers = self._publishers, None
        if publishers is not None:
            with self._costing():
                publishers.close()
