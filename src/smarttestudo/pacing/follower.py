# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics that pass exactly the stamps that another topic passed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial

from smarttestudo.pacing.grid import Pace
from smarttestudo.pacing.sample import Pacer, Pass, Sample

IsHeld = Callable[[Sample], bool]
"""Whether a sample did not pass, but still may."""


class FollowerNotifier:
    """A leader's decisions on its stamps: passed, held, or decided against.

    Samples without a stamp are not announced. ``followers`` are called in the order in which they were added.
    """

    __slots__ = ("_held", "followers")

    def __init__(self) -> None:
        self.followers: list[Follower] = []
        self._held: list[Sample] = []

    def add(self, follower: Follower, pace: Pace) -> None:
        """Call ``follower`` from now on."""
        self.followers.append(follower)
        follower.leader_is_full = pace.is_full

    def on_offer(self, sample: Sample, passes: Sequence[Pass], is_held: IsHeld, now_ns: int) -> None:
        """The leader was offered ``sample`` and relays ``passes``."""
        self.on_wake(passes, is_held, now_ns)
        if passes:
            return
        if is_held(sample):
            self._held.append(sample)
            self._notify(Follower.held, sample)
        else:
            self._notify(Follower.decided_against, sample)

    def on_wake(self, passes: Sequence[Pass], is_held: IsHeld, now_ns: int) -> None:
        """The leader relays ``passes``, and may have let go of others."""
        relayed = [sample for sample, _ in passes]
        undecided = [sample for sample in self._held if sample not in relayed]
        self._held = [sample for sample in undecided if is_held(sample)]
        for sample in undecided:
            if sample not in self._held:
                self._notify(Follower.decided_against, sample)
        for sample, repeated in passes:
            self._notify(partial(Follower.passed, now_ns=now_ns, repeated=repeated), sample)

    def on_pace(self, pace: Pace, is_held: IsHeld, now_ns: int) -> None:
        """The leader's pace changed, and it may have let go of what it held."""
        for follower in self.followers:
            follower.leader_is_full = pace.is_full
        self.on_wake((), is_held, now_ns)

    def _notify(self, decision: Callable[[Follower, bytes], None], sample: Sample) -> None:
        if sample.stamp is not None:
            for follower in self.followers:
                decision(follower, sample.stamp)


MAX_PENDING = 32
MAX_REMEMBERED = 256


class Follower(Pacer):
    """The pacer of a topic that passes exactly the header stamps its leader passed.

    Messages may arrive before or after the leader's. A message before the leader's decision is
    pending; what the decisions let go is given out by ``wake``, to be called after each call on the
    leader. At most ``MAX_PENDING`` messages are pending (the oldest that the leader does not hold makes room)
    and ``MAX_REMEMBERED`` decisions remembered. While the leader is Full, everything passes. Of its own
    rates, only Off is obeyed. A leader that repeats a stamp repeats its partner too.
    """

    __slots__ = (
        "_held",
        "_is_off",
        "_latest",
        "_outbox",
        "_pending",
        "_verdicts",
        "discarded",
        "leader_is_full",
        "wake_ns",
    )

    def __init__(self) -> None:
        self.leader_is_full = False
        self.discarded = 0
        """Messages that made room, and those without a readable stamp."""
        self.wake_ns: int | None = None
        self._is_off = False
        self._latest: Sample | None = None
        self._pending: dict[bytes, Sample] = {}
        self._held: set[bytes] = set()
        self._verdicts: dict[bytes, bool] = {}
        self._outbox: list[Pass] = []

    @property
    def undecided(self) -> int:
        """How many messages wait for the leader's decision."""
        return len(self._pending)

    def offer(self, sample: Sample, _now_ns: int, /) -> Sequence[Pass]:
        """Pace ``sample``, which arrived: return it if it passes now, else nothing."""
        if self._is_off:
            return ()
        if self.leader_is_full:
            return self._pass(sample)
        if sample.stamp is None:
            self.discarded += 1
            return ()
        verdict = self._verdicts.get(sample.stamp)
        if verdict is None:
            self._wait(sample.stamp, sample)
        return self._pass(sample) if verdict else ()

    def wake(self, _now_ns: int, /) -> Sequence[Pass]:
        """Samples to relay now after the leader's decisions."""
        passes, self._outbox = self._outbox, []
        self.wake_ns = None
        return passes

    def set_rate(self, rate_hz: float, _now_ns: int, /) -> None:
        """Off (0) stops the topic, any other rate leaves it to its leader."""
        self._is_off = rate_hz == 0
        if self._is_off:
            self._pending.clear()
            self._outbox.clear()
            self._latest = self.wake_ns = None

    def forget(self) -> None:
        """The topic has another type now: what waits is of the old one and must not go out."""
        self._pending.clear()
        self._outbox.clear()
        self._latest = self.wake_ns = None

    def finish(self) -> None:
        """The recording ended; what the leader still holds decides over what still waits."""

    def passed(self, stamp: bytes, now_ns: int, *, repeated: bool) -> None:
        """The leader passed ``stamp``, for the first time or again."""
        self._decide(stamp, passed=True)
        sample = self._pending.pop(stamp, None)
        if sample is not None:
            self._outbox.extend(self._pass(sample))
        elif repeated and self._latest is not None and self._latest.stamp == stamp:
            self._outbox.append(Pass(self._latest, repeated=True))
        if self._outbox:
            self.wake_ns = now_ns

    def held(self, stamp: bytes) -> None:
        """The leader holds ``stamp`` back and may pass it later."""
        self._held.add(stamp)
        self._verdicts.pop(stamp, None)

    def decided_against(self, stamp: bytes) -> None:
        """The leader will not pass ``stamp``."""
        self._decide(stamp, passed=False)
        self._pending.pop(stamp, None)

    def _pass(self, sample: Sample) -> tuple[Pass]:
        self._latest = sample
        return (Pass(sample),)

    def _decide(self, stamp: bytes, *, passed: bool) -> None:
        self._held.discard(stamp)
        self._verdicts[stamp] = passed
        if len(self._verdicts) > MAX_REMEMBERED:
            del self._verdicts[next(iter(self._verdicts))]

    def _wait(self, stamp: bytes, sample: Sample) -> None:
        if stamp in self._pending:
            self.discarded += 1
        self._pending[stamp] = sample
        if len(self._pending) > MAX_PENDING:
            self.discarded += 1
            oldest = next((key for key in self._pending if key not in self._held), stamp)
            del self._pending[oldest]


def leaders(paced_with: Mapping[str, str], relayed: Collection[str]) -> dict[str, str]:
    """The leader of each follower: follower → leader, for ``relayed`` topics only.

    A chain ends at its last relayed topic, which leads them all. Of topics that name each other in a
    circle, the first by name leads. A topic whose leader is not relayed has its own grid; it is left out.
    """
    roots = {topic: _root(topic, paced_with, relayed) for topic in paced_with if topic in relayed}
    return {topic: root for topic, root in roots.items() if root != topic}


def _root(topic: str, paced_with: Mapping[str, str], relayed: Collection[str]) -> str:
    path = [topic]
    while (leader := paced_with.get(path[-1])) is not None and leader in relayed:
        if leader in path:
            return min(path[path.index(leader) :])
        path.append(leader)
    return path[-1]
