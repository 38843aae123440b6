# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Observations of an operator over a radio: small topics, one of which every message matters, large ones."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from thin_link.cases import IMU, ODOM, SCAN, WARM_S, Seen, Target, quantile
from thin_link.traffic import Topic

LAST_S = 1.0
"""Messages sent later may be under way when a run ends."""
_SAMPLE_S = 0.01
TF = Topic(name="/tf", size_bytes=240, hz=30, priority=4, zenoh_priority="DATA_HIGH")
EVENTS = Topic(
    name="/events",
    size_bytes=200,
    hz=10,
    priority=5,
    zenoh_priority="INTERACTIVE_HIGH",
    reliable=True,
    is_full=True,
)
JPEG = Topic(name="/camera/jpeg", size_bytes=0, hz=10, priority=1, zenoh_priority="DATA_LOW")
CLOUD = Topic(name="/cloud", size_bytes=1_250_000, hz=1, priority=2, zenoh_priority="DATA")
SMALL = (ODOM, IMU, SCAN, TF)
LARGE = (JPEG, CLOUD)


@dataclass(frozen=True, slots=True, kw_only=True)
class Observation:
    """One that can be made of a run: its words in tables, and the number."""

    text: str
    of: Callable[[Seen], float]


def _age_ms(share: float, *topics: Topic) -> Callable[[Seen], float]:
    """The age that ``share`` of the messages of these topics together do not exceed."""
    return lambda seen: 1e3 * quantile(seen.ages_s(topics), share)


def _stale_s(seen: Seen, topic: Topic) -> list[float]:
    """How old the newest message of a topic was, seen a hundred times a second, sorted."""
    # Who shows nothing is as stale as the run is long.
    newest = [(0.0, 0.0)]
    for one in sorted(seen.arrived.get(topic.name, ()), key=lambda one: one.at_s):
        newest.append((one.at_s, max(one.sent_s, newest[-1][1])))
    times_s = [at_s for at_s, _ in newest]
    count = int((seen.seconds - WARM_S) / _SAMPLE_S)
    samples_s = [WARM_S + number * _SAMPLE_S for number in range(count)]
    return sorted(at_s - newest[bisect_right(times_s, at_s) - 1][1] for at_s in samples_s)


def _small_stale_p95_ms(seen: Seen) -> float:
    """Beyond a period, which the newest message is old even on a wire."""
    return max(1e3 * (quantile(_stale_s(seen, one), 0.95) - 1 / one.hz) for one in SMALL)


def _delivered(seen: Seen, topic: Topic) -> float:
    """The share of a topic's messages that arrive, of those sent after the warm-up."""
    end_s = seen.seconds - LAST_S
    numbers = {one.number for one in seen.arrived.get(topic.name, ()) if WARM_S <= one.sent_s < end_s}
    return min(1.0, len(numbers) / ((end_s - WARM_S) * topic.hz))


def _full_missing(seen: Seen) -> float:
    """How many messages neither arrived nor were counted as overflowed."""
    there = {one.number for one in seen.arrived.get(EVENTS.name, ())}
    return seen.published[EVENTS.name] - len(there) - seen.overflowed.get(EVENTS.name, 0)


def _large_whole(seen: Seen) -> float:
    """The share of images and clouds sent that arrived; not a number for an end that does not count them."""
    if not seen.begun:
        return float("nan")
    begun = sum(seen.begun.get(one.name, 0) for one in LARGE)
    arrived = sum(len(seen.arrived.get(one.name, ())) for one in LARGE)
    return arrived / begun if begun else 0.0


def _older_after_newer(seen: Seen) -> float:
    """How often a message was shown after a newer one of its topic."""
    count = 0
    for arrivals in seen.arrived.values():
        newest = -1
        for one in arrivals:
            count += one.number < newest
            newest = max(newest, one.number)
    return count


OBSERVED: Mapping[str, Observation] = {
    "small_age_p95_ms": Observation(text="small topics, age p95 ms", of=_age_ms(0.95, *SMALL)),
    "small_age_max_ms": Observation(text="small topics, age max ms", of=_age_ms(1.0, *SMALL)),
    "small_stale_p95_ms": Observation(
        text="small topics, newest older than a period by p95 ms", of=_small_stale_p95_ms
    ),
    "small_delivered": Observation(
        text="small topics, share that arrives", of=lambda seen: min(_delivered(seen, one) for one in SMALL)
    ),
    "used": Observation(text="link used, of what it does not lose", of=lambda seen: seen.used),
    "full_missing": Observation(text="Full topic, missing and not counted", of=_full_missing),
    "full_age_p95_ms": Observation(text="Full topic, age p95 ms", of=_age_ms(0.95, EVENTS)),
    "large_whole": Observation(text="images and clouds begun that arrive whole", of=_large_whole),
    "older_after_newer": Observation(text="older shown after newer", of=_older_after_newer),
}
"""By the names that files have for them."""

_LEAST_SHARE = 1 / 6
"""A third of a half."""


def judge_fairness(seen: Seen) -> list[Target]:
    """Whether neither of two takes more from the other than is fair."""
    assert seen.other_share is not None
    small = OBSERVED["small_age_p95_ms"]
    return [
        Target(
            name="share of what goes beside",
            value=seen.other_share,
            least=round(_LEAST_SHARE, 3),
            most=round(1 - _LEAST_SHARE, 3),
        ),
        Target(name=small.text, value=small.of(seen)),
    ]
