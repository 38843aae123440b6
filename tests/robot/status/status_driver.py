# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A live run in virtual time: sources of any rate, and a look at the status each second."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Any

from loop.loop_driver import SECOND, LoopDriver
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.status import ProcessReading, RulesInForce, RuntimeStatus
from smarttestudo.robot.losses import SourceLoss
from smarttestudo.robot.status import LiveStatus, MeasuredTopic, TopicLink, TopicMeters

RULES = RulesInForce(paths=("/etc/testudo/warehouse.adirf",), sha256="0" * 64)
SIZE_BYTES = 500


def process_at(now_ns: int) -> ProcessReading:
    """A process that takes 4 % of a core."""
    return ProcessReading(cpu_ns=now_ns // 25, steady_ns=now_ns, resident_bytes=64_000_000)


def payload(stamp_ns: int) -> bytes:
    """A message with that header stamp."""
    return (b"\x00\x01\x00\x00" + struct.pack("<iI", *divmod(stamp_ns, SECOND))).ljust(SIZE_BYTES, b"\x00")


def linked(topic: str, **link: Any) -> TopicLink:
    """The links of a topic that is published, relayed and subscribed."""
    usual: dict[str, Any] = {"type_name": "sensor_msgs/msg/Imu", "publishers": 1, "subscribers": 1}
    return TopicLink(output=f"/testudo{topic}", **{**usual, **link})


@dataclass(kw_only=True)
class StatusDriver:
    """``source_hz`` are the rates of the sources; ``links`` what is unusual of a topic."""

    rules: str
    source_hz: dict[str, float]
    links: dict[str, dict[str, object]] = field(default_factory=dict)
    profile: Profile | None = None
    budget_kb_per_s: float | None = None
    lost: dict[str, SourceLoss] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.driver = LoopDriver(self.rules, self.profile, budget_kb_per_s=self.budget_kb_per_s)
        self.live = LiveStatus("/smarttestudo", process_at(0))
        self.meters: dict[str, TopicMeters] = {}
        self.due_ns = dict.fromkeys(self.source_hz, 0)

    def status_at(self, until_s: int) -> RuntimeStatus:
        """Run on to ``until_s`` and look there."""
        for second in range(self.driver.now_ns // SECOND + 1, until_s + 1):
            self.send_until(second)
            status = self.look()
        return status

    def look(self) -> RuntimeStatus:
        """The status now."""
        now_ns, loop = self.driver.now_ns, self.driver.loop
        topics = {topic: self.measured(topic) for topic in loop.knowledge.plan}
        return self.live.measure(loop, topics, RULES, process_at(now_ns), now_ns)

    def measured(self, topic: str) -> MeasuredTopic:
        """The topic as its status sees it."""
        statistics, meters = self.driver.loop.relays.statistics[topic], self.meters.get(topic)
        if meters is None or meters.statistics is not statistics:
            meters = self.meters[topic] = TopicMeters(statistics)
        return MeasuredTopic(linked(topic, **self.links.get(topic, {})), meters, self.lost.get(topic))

    def send_until(self, end_s: int) -> None:
        """Run on to ``end_s``."""
        end_ns = end_s * SECOND
        while self.due_ns and min(self.due_ns.values()) < end_ns:
            topic = min(self.due_ns, key=lambda name: self.due_ns[name])
            sent = len(self.driver.relayed)
            self.driver.send(topic, self.due_ns[topic], payload(self.due_ns[topic]), SIZE_BYTES)
            for relayed in self.driver.relayed[sent:]:
                if relayed.topic in self.meters:
                    self.meters[relayed.topic].note(relayed)
            self.due_ns[topic] += round(SECOND / self.source_hz[topic])
        self.driver.wait_until(end_ns)
