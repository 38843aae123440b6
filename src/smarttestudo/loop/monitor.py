# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Observations, and time alone, to values of signals."""

from __future__ import annotations

from collections.abc import Iterable

from smarttestudo.domain.observation import (
    Arrival,
    LinkBudget,
    ListenersChanged,
    Observation,
    SourceChanged,
    Undecodable,
)
from smarttestudo.loop.knowledge.knowledge import Knowledge
from smarttestudo.loop.knowledge.watched_topic import Reading, WatchedTopic


def monitor(knowledge: Knowledge, observations: Iterable[Observation], now_ns: int) -> list[Reading]:
    """The values of the signals of every topic that was observed or that time alone changes.

    ``now_ns`` is the steady time. Topics that no check reads cost a look-up.
    """
    touched: dict[str, WatchedTopic] = {}
    for observation in observations:
        if isinstance(observation, LinkBudget):
            knowledge.set_budget(observation)
            continue
        _meter(knowledge, observation, now_ns)
        if isinstance(observation, ListenersChanged):
            continue
        watched = knowledge.watched.get(observation.topic)
        if watched is not None:
            touched[observation.topic] = watched
            _take(knowledge, watched, observation, now_ns)
    for topic in knowledge.watch_alarms.take_due(now_ns):
        touched[topic] = knowledge.watched[topic]
    readings: list[Reading] = []
    for topic, watched in touched.items():
        readings += watched.readings(now_ns)
        knowledge.watch_alarms.set(topic, watched.next_change_ns(now_ns))
    return readings


def meter(knowledge: Knowledge, topic: str, size_bytes: int, clock_ns: int) -> bool:
    """Count, for the link's budget, a message of a topic that no check reads; whether that needs a step.

    It does where the topic asks for a part from now on; else the link looks at what it counted from time to
    time.
    """
    if knowledge.link is None:
        return False
    now_ns = knowledge.time.advance(clock_ns)
    return topic not in knowledge.unheard and knowledge.link.record(topic, now_ns, size_bytes)


def _meter(
    knowledge: Knowledge, observation: Arrival | SourceChanged | ListenersChanged, now_ns: int
) -> None:
    """Record an observation for the link's budget."""
    topic, is_over = observation.topic, False
    match observation:
        case Arrival(size_bytes=size_bytes):
            if knowledge.link is not None and topic not in knowledge.unheard:
                knowledge.link.record(topic, now_ns, size_bytes)
        case SourceChanged(publishers=publishers):
            is_over = publishers == 0
        case ListenersChanged(are_there=True):
            knowledge.unheard.discard(topic)
        case ListenersChanged():
            knowledge.unheard.add(topic)
            is_over = True
    if is_over and knowledge.link is not None:
        knowledge.link.end(topic, now_ns)


def _take(
    knowledge: Knowledge, watched: WatchedTopic, observation: Arrival | SourceChanged, now_ns: int
) -> None:
    match observation:
        case Arrival():
            watched.source.record(now_ns)
            watched.arrivals.record(now_ns, observation.size_bytes)
            if watched.fields:
                _read(knowledge, watched, observation)
        case SourceChanged():
            watched.change_source(observation)


def _read(knowledge: Knowledge, watched: WatchedTopic, arrival: Arrival) -> None:
    if arrival.message is None or isinstance(arrival.message, Undecodable):
        watched.fields.forget()
        knowledge.undecodable[arrival.topic] += 1
        return
    for signal in watched.fields.read(arrival.message):
        knowledge.unknown_values[signal] += 1
