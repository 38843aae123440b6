# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a replay of the demo's recording costs beside a plain copy of it with the same library.

Run it with ``python benchmarks/replay_speed.py``. Copies and replays alternate in one process, and each
replay is compared with the copy beside it, so that a machine busy for a while slows both sides of a ratio.
"""

from __future__ import annotations

import argparse
import gc
import shutil
import statistics
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.resources import as_file, files
from pathlib import Path

from rosbags.rosbag2 import Reader, Writer

from smarttestudo.bags.reader import open_recording
from smarttestudo.demo.mission import record_mission
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.rules.rule_sets import load_rules
from smarttestudo.simulation.warehouse import patrol

WARM_UPS = 1
AIM = 1.5


def plain_copy(bag: Path, output: Path) -> None:
    """Every message from one bag to another, with rosbags alone."""
    with Reader(bag) as reader, Writer(output, version=8) as writer:
        connections = {
            connection.id: writer.add_connection(
                connection.topic,
                connection.msgtype,
                msgdef=connection.msgdef.data,
                rihs01=connection.digest,
                offered_qos_profiles=connection.ext.offered_qos_profiles,  # type: ignore[union-attr]
            )
            for connection in reader.connections
        }
        for connection, stamp_ns, payload in reader.messages():
            writer.write(connections[connection.id], stamp_ns, payload)


def replay_mission(bag: Path, output: Path, budget_kb_per_s: float | None = None) -> None:
    """The thesis's evaluation rules over the bag, from the rule file to the written recording."""
    with as_file(files("smarttestudo.simulation") / "warehouse.adirf") as rule_file:
        rules = load_rules([rule_file])
    with open_recording(bag) as recording:
        replay(
            ReplayRequest(
                recording=recording,
                rule_set=rules.rule_set,
                output=output,
                budget_kb_per_s=budget_kb_per_s,
            )
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """What one run took: ``wall_s`` on the clock on the wall, ``cpu_s`` of the processor, in this process."""

    wall_s: float
    cpu_s: float


def cost_of(work: Callable[[Path, Path], None], bag: Path, output: Path) -> Cost:
    """What ``work`` takes; its output is gone afterwards."""
    gc.collect()
    wall_s, cpu_s = time.perf_counter(), time.process_time()
    work(bag, output)
    cost = Cost(wall_s=time.perf_counter() - wall_s, cpu_s=time.process_time() - cpu_s)
    shutil.rmtree(output)
    return cost


def compare(bag: Path, folder: Path, turns: int, budget_kb_per_s: float | None) -> list[tuple[Cost, Cost]]:
    """The costs of a copy and of a replay, turn by turn; which comes first alternates."""
    replay_within = partial(replay_mission, budget_kb_per_s=budget_kb_per_s)
    pairs = []
    for turn in range(-WARM_UPS, turns):
        works = (plain_copy, replay_within) if turn % 2 else (replay_within, plain_copy)
        costs = {work: cost_of(work, bag, folder / "output") for work in works}
        if turn >= 0:
            pairs.append((costs[plain_copy], costs[replay_within]))
    return pairs


def report(name: str, unit_s: Callable[[Cost], float], pairs: list[tuple[Cost, Cost]]) -> None:
    """One line: both medians, the median of the ratios, and the ratios' middle half."""
    copies_s, replays_s = ([unit_s(cost) for cost in costs] for costs in zip(*pairs, strict=True))
    ratios = [replay_s / copy_s for copy_s, replay_s in zip(copies_s, replays_s, strict=True)]
    low, middle, high = statistics.quantiles(ratios, n=4)
    medians = f"plain copy {statistics.median(copies_s):.3f} s, replay {statistics.median(replays_s):.3f} s"
    print(f"{name}: {medians}, ratio {middle:.2f} ({low:.2f} to {high:.2f})")


def main() -> None:
    """Print what both cost and the median of their ratios, by the wall's clock and by the processor's."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--budget", metavar="KB/S", type=float, help="replay within a budget")
    parser.add_argument("--seconds", type=float, default=200.0, help="of the demo's mission")
    parser.add_argument("--turns", type=int, default=15, help="at least two")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="testudo-benchmark-") as name:
        folder = Path(name)
        bag = folder / "mission"
        record_mission(
            bag, route=patrol(), seconds=arguments.seconds, seed=1, full_images=False, report=lambda _: None
        )
        with open_recording(bag) as recording:
            print(f"the demo's bag, {recording.message_count:,} messages; medians of {arguments.turns} pairs")
        pairs = compare(bag, folder, arguments.turns, arguments.budget)
    report("wall time", lambda cost: cost.wall_s, pairs)
    report("CPU time ", lambda cost: cost.cpu_s, pairs)
    print(f"aim: a ratio of at most {AIM}")


if __name__ == "__main__":
    main()
