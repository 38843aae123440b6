# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How exactly a throttle meets its rate: prints the README's table, the same on every machine.

``python benchmarks/throttle_accuracy.py`` relays 60 virtual seconds of a source with Gaussian jitter through
the gate that throttles use (``now - last >= period``, then ``last = now``) and through a ``TopicPacer``.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

from smarttestudo.domain.units import NS_PER_S, ns_from_s
from smarttestudo.pacing.sample import Sample
from smarttestudo.pacing.topic_pacer import TopicPacer

SECONDS = 60
SEED = 2026
RATES_HZ = ((30, 20), (10, 8), (25.5, 10), (50, 49), (195, 50))
JITTERS_MS = (0, 1, 2)


@dataclass(frozen=True, slots=True, kw_only=True)
class Accuracy:
    """Mean rates in Hz of what each way relays of one source, by its jitter in ms (standard deviation)."""

    source_hz: float
    target_hz: float
    gate_hz: dict[int, float]
    ours_hz: dict[int, float]


def arrivals_ns(source_hz: float, jitter_ms: float, rng: random.Random) -> list[int]:
    """The arrival times of ``SECONDS`` of a source."""
    ideal_s = (i / source_hz for i in range(int(SECONDS * source_hz) + 1))
    return sorted(ns_from_s(1 + at_s + rng.gauss(0, jitter_ms / 1000)) for at_s in ideal_s)


def gated_ns(times_ns: list[int], target_hz: float) -> list[int]:
    """What the usual gate passes."""
    passed_ns = times_ns[:1]
    for now_ns in times_ns[1:]:
        if now_ns - passed_ns[-1] >= NS_PER_S / target_hz:
            passed_ns.append(now_ns)
    return passed_ns


def paced_ns(times_ns: list[int], target_hz: float) -> list[int]:
    """What our pacer passes."""
    pacer = TopicPacer()
    pacer.set_rate(target_hz, times_ns[0])
    return [now_ns for now_ns in times_ns if pacer.offer(Sample(payload=b"", size_bytes=0), now_ns)]


def mean_hz(times_ns: list[int]) -> float:
    """(n−1)/(last−first)."""
    return (len(times_ns) - 1) * NS_PER_S / (times_ns[-1] - times_ns[0])


def accuracies() -> list[Accuracy]:
    """One for each pair of source and target."""
    rng = random.Random(SEED)
    measured = []
    for source_hz, target_hz in RATES_HZ:
        times_ns = {jitter_ms: arrivals_ns(source_hz, jitter_ms, rng) for jitter_ms in JITTERS_MS}
        gate_hz = {jitter_ms: mean_hz(gated_ns(times, target_hz)) for jitter_ms, times in times_ns.items()}
        ours_hz = {jitter_ms: mean_hz(paced_ns(times, target_hz)) for jitter_ms, times in times_ns.items()}
        measured.append(Accuracy(source_hz=source_hz, target_hz=target_hz, gate_hz=gate_hz, ours_hz=ours_hz))
    return measured


def table(measured: list[Accuracy]) -> str:
    """The Markdown table."""
    jitters = [f"σ = {jitter_ms} ms" for jitter_ms in JITTERS_MS]
    head = ["source → target, Hz", *(f"gate, {j}" for j in jitters), *(f"SmartTestudo, {j}" for j in jitters)]
    lines = [head, ["---", *["---:"] * (2 * len(jitters))]]
    for row in measured:
        values = [*row.gate_hz.values(), *row.ours_hz.values()]
        lines.append([f"{row.source_hz:g} → {row.target_hz:g}", *(f"{value:.2f}" for value in values)])
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


if __name__ == "__main__":
    print(table(accuracies()))
