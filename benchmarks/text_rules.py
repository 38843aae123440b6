# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What another text costs the evaluator, and a whole step, among 10 000 checks of texts and among 10.

Run it with ``python benchmarks/text_rules.py``. Robots in a fleet have a mode each, and a rule for each of
their modes. Each time another robot is in another mode, so that one rule ends and another begins; a step
also plans the new rate and decides. All are done in turns in one process, and their medians are printed.
"""

from __future__ import annotations

import argparse
import statistics
import time
from types import SimpleNamespace

from live.zone_rules import knowledge_of
from smarttestudo.domain.observation import Arrival
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.signal import Signal, SignalKind
from smarttestudo.loop import step

CHANGES = 2000
PERIOD_NS = 1_000_000
AIM_US = 50.0


def modes_of(robot: int, modes: int) -> str:
    """A rule file with a rule for each mode of a robot."""
    blocks = [
        f'If (CheckValue /robot_{robot}/mode data = "mode {mode}") '
        f"Then SetFrequency /robot_{robot}/scan {2 + mode} EndIf"
        for mode in range(modes)
    ]
    return "\n".join(["begin", f"SetFrequency /robot_{robot}/scan 1", *blocks, "end"])


class Fleet:
    """Rules for so many robots, and modes of each; what is asked of it takes ``CHANGES`` texts."""

    def __init__(self, robots: int, modes: int) -> None:
        self._robots, self._modes = robots, modes
        self._knowledge = knowledge_of((modes_of(robot, modes) for robot in range(robots)), TopicProfile())
        self._number = self._now_ns = 0
        self.step_us()

    def _next(self) -> tuple[str, str]:
        """The topic of the next robot, and its next mode."""
        self._number += 1
        number, robots = self._number, self._robots
        return f"/robot_{number % robots}/mode", f"mode {number // robots % self._modes}"

    def update_us(self) -> float:
        """Microseconds that a text takes to be compared, and carried to the rules that it turns."""
        evaluator = self._knowledge.evaluator
        texts = [
            (Signal(topic, "data", SignalKind.TEXT), mode)
            for topic, mode in (self._next() for _ in range(CHANGES))
        ]
        start = time.process_time()
        for signal, mode in texts:
            evaluator.set(signal, mode)
            evaluator.take_changed_topics()
        return (time.process_time() - start) / CHANGES * 1e6

    def step_us(self) -> float:
        """Microseconds of a step that a text makes."""
        arrivals = [
            Arrival(topic=topic, size_bytes=16, message=SimpleNamespace(data=mode))
            for topic, mode in (self._next() for _ in range(CHANGES))
        ]
        start = time.process_time()
        for arrival in arrivals:
            self._now_ns += PERIOD_NS
            step(self._knowledge, (arrival,), self._now_ns)
        return (time.process_time() - start) / CHANGES * 1e6


def main() -> None:
    """Measure both sizes in turns, and print their medians."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--side", type=int, default=100, help="as many robots, and modes of each")
    parser.add_argument("--turns", type=int, default=9)
    arguments = parser.parse_args()
    few, many = Fleet(1, 10), Fleet(arguments.side, arguments.side)
    turns = [
        (few.update_us(), few.step_us(), many.update_us(), many.step_us()) for _ in range(arguments.turns)
    ]
    few_us, few_step_us, many_us, many_step_us = map(statistics.median, zip(*turns, strict=True))
    print(
        f"10 checks of texts: an update {few_us:5.1f} µs, a step {few_step_us:5.1f} µs; "
        f"{arguments.side**2} checks: {many_us:5.1f} µs (aim: at most {AIM_US:g} µs), {many_step_us:5.1f} µs"
    )


if __name__ == "__main__":
    main()
