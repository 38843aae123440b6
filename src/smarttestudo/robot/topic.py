# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One topic of a robot while it runs: its source, its publishers, and the relay between them."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from smarttestudo.domain.errors import TestudoError, error_at
from smarttestudo.domain.names import require_publishable
from smarttestudo.domain.robot import DataPath, Endpoint, Payload, Publisher, Qos, Receive, Subscription
from smarttestudo.robot.publisher_pool import PublisherPool

OnProblem = Callable[[TestudoError | None], None]
"""Takes what failed for a topic, or nothing where it works again."""
DEPTH = 10
# The last messages of all publishers come at once, and one may keep more of them than ten others.
LATCHED_SUBSCRIPTION_DEPTH = 100
# What is recorded is recorded whole, bursts too.
RECORDED_SUBSCRIPTION_DEPTH = 100


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveSource:
    """Source of a topic: what its publishers have in common.

    ``other_types`` are types that some publish beside ``type_name``; those publishers do not count. ``gids``
    are those of the publishers, of the last ones where none is left; a source with others is still the same.
    """

    type_name: str
    publishers: int
    qos: Qos
    other_types: tuple[str, ...] = ()
    gids: frozenset[bytes] = field(default=frozenset(), compare=False)

    @property
    def subscription_qos(self) -> Qos:
        """QoS that a subscription asks for, ``qos`` being what a publisher offers."""
        if not self.qos.transient_local:
            return self.qos
        return replace(self.qos, depth=max(LATCHED_SUBSCRIPTION_DEPTH, self.qos.depth))


def live_source(endpoints: Sequence[Endpoint], before: LiveSource | None) -> LiveSource | None:
    """The source that ``endpoints`` make, after ``before``; ``None`` before the first publisher.

    A subscription may request only what every publisher offers, and its output offers no more.
    A source without publishers keeps its type and QoS, so that it is received at once when it comes back.
    """
    types = sorted({endpoint.type_name for endpoint in endpoints})
    if not types:
        return None if before is None else replace(before, publishers=0, other_types=())
    type_name = before.type_name if before is not None and before.type_name in types else types[0]
    counted = [endpoint for endpoint in endpoints if endpoint.type_name == type_name]
    transient_local = all(endpoint.transient_local for endpoint in counted)
    return LiveSource(
        type_name=type_name,
        publishers=len(counted),
        qos=Qos(
            reliable=all(endpoint.reliable for endpoint in counted),
            transient_local=transient_local,
            depth=max(DEPTH, 2 * len(counted)) if transient_local else DEPTH,
        ),
        other_types=tuple(other for other in types if other != type_name),
        gids=frozenset(endpoint.gid for endpoint in counted),
    )


def suits(had: LiveSource, now: LiveSource) -> bool:
    """Whether what was opened for ``had`` does for ``now``: latched messages are lost with what held them."""
    return (
        had.type_name == now.type_name
        and replace(had.qos, depth=0) == replace(now.qos, depth=0)
        and had.qos.depth >= now.qos.depth
    )


class OpenTopic:
    """Subscription and publisher that are open for one topic, following its source.

    ``output`` is its output topic, ``None`` if it is only watched. ``has_header`` is whether its messages
    begin with a std_msgs/Header. ``unheard`` are publishers whose
    messages are dropped. Of one that ``is_recorded``, more may wait. Unless it ``is_told``, whoever reads it
    does not know its source. ``subscriptions`` counts how often it was subscribed to.

    Nothing here raises: whatever fails in the middleware, or where a message goes, costs this topic only. It
    is its ``problem``, which ``on_problem`` is told. What could not be opened is tried again when the source
    or the need for it changes.
    """

    def __init__(
        self,
        topic: str,
        output: str | None,
        path: DataPath,
        receive: Receive,
        *,
        on_problem: OnProblem,
        priority: float,
    ) -> None:
        self.topic = topic
        self.output = output
        self.source: LiveSource | None = None
        self.has_header = False
        self.unheard: frozenset[Hashable] = frozenset()
        self.problem: str | None = None
        self._path = path
        self._receive = receive
        self._on_problem = on_problem
        self._priority = priority
        self.is_wanted = False
        self.is_recorded = False
        self.is_told = True
        self._is_refused = False
        self._opened_for: LiveSource | None = None
        self.subscription: Subscription | None = None
        self.subscriptions = 0
        self._publishers: PublisherPool | None = None

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

    def keeps_subscription(self, *, is_recorded: bool) -> bool:
        """Whether another output takes nothing from a topic that ``is_recorded`` and was before.

        What is latched must come anew for another output; nobody misses what is not recorded meanwhile.
        """
        return self.is_recorded and is_recorded and not self.is_latched

    @property
    def is_latched(self) -> bool:
        """Whether it is open for a source that keeps its last messages for late subscribers."""
        return self._opened_for is not None and self._opened_for.qos.transient_local

    def serve(self, output: str | None) -> None:
        """Have another output topic, or none, by the same subscription."""
        self.output = output
        self._close_publishers()
        if output is not None and self._opened_for is not None:
            with self._costing(closes=True):
                self._publishers = self._publishers_to(output, self._opened_for)

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
        self._set_problem(error_at(self.topic, error))

    def ends(self, *, is_published: bool) -> tuple[Subscription, Publisher | None] | None:
        """Where all messages come in and go out, if there is one place for each, and none is dropped.

        Unless it ``is_published``, nothing goes out there; what is latched has no such ends then.
        """
        if self.subscription is None or self.unheard:
            return None
        if self._publishers is None or not is_published:
            return None if self.is_latched else (self.subscription, None)
        publisher = self._publishers.only
        return None if publisher is None else (self.subscription, publisher)

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
        require_publishable(output, self.topic)
        return PublisherPool(
            lambda: self._path.advertise(output, source.type_name, source.qos),
            one_each=self._path.tells_publishers and (source.qos.transient_local or self._path.keeps_newest),
        )

    def _subscribe(self, source: LiveSource) -> None:
        qos = source.subscription_qos
        if self.is_recorded:
            qos = replace(qos, depth=max(RECORDED_SUBSCRIPTION_DEPTH, qos.depth))
        self.subscription = self._path.subscribe(
            self.topic, source.type_name, qos, self._received, priority=self._priority
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

    def _received(self, payload: Payload, publisher: Hashable) -> None:
        if publisher in self.unheard:
            return
        try:
            self._receive(payload, publisher)
        except Exception as error:  # noqa: BLE001 - see the class
            self.fail(error)
