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

from rosbags.rosbag2 import Reader, StoragePlugin, Writer

from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.recording import Storage
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.rules.rule_sets import load_rules
from smarttestudo.simulation.mission import record_mission
from smarttestudo.simulation.warehouse import patrol

WARM_UPS = 1
AIMS = {Storage.SQLITE3: 1.3, Storage.MCAP: 1.2}

Work = Callable[[Path, Path], None]
"""Makes a bag from another one."""


def plain_copy(bag: Path, output: Path, storage: Storage) -> None:
    """Every message from one bag to another, with rosbags alone."""
    plugin = StoragePlugin[storage.name]
    with Reader(bag) as reader, Writer(output, version=8, storage_plugin=plugin) as writer:
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


def replay_mission(bag: Path, output: Path, storage: Storage, budget_kb_per_s: float | None) -> None:
    """The thesis's evaluation rules over the bag, from the rule file to the written recording."""
    with as_file(files("smarttestudo.simulation") / "warehouse.adirf") as rule_file:
        rules = load_rules([rule_file])
    with open_recording(bag) as recording:
        replay(
            ReplayRequest(
                recording=recording,
                rule_set=rules.rule_set,
                output=output,
                storage=storage,
                budget_kb_per_s=budget_kb_per_s,
            )
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Cost:
    """What one run took: ``wall_s`` on the clock on the wall, ``cpu_s`` of the processor, in this process."""

    wall_s: float
    cpu_s: float


def cost_of(work: Work, bag: Path, output: Path) -> Cost:
    """What ``work`` takes; its output is gone afterwards."""
    gc.collect()
    wall_s, cpu_s = time.perf_counter(), time.process_time()
    work(bag, output)
    cost = Cost(wall_s=time.perf_counter() - wall_s, cpu_s=time.process_time() - cpu_s)
    shutil.rmtree(output)
    return cost


def compare(copy: Work, replayed: Work, bag: Path, folder: Path, turns: int) -> list[tuple[Cost, Cost]]:
    """The costs of a copy and of a replay, turn by turn; which comes first alternates."""
    pairs = []
    for turn in range(-WARM_UPS, turns):
        works = (copy, replayed) if turn % 2 else (replayed, copy)
        costs = {work: cost_of(work, bag, folder / "output") for work in works}
        if turn >= 0:
            pairs.append((costs[copy], costs[replayed]))
    return pairs


def record(folder: Path, seconds: float, storage: Storage) -> Path:
    """The demo's recording in ``storage``; the demo itself writes SQLite."""
    bag, stored = folder / "mission", folder / storage.value
    record_mission(bag, route=patrol(), seconds=seconds, seed=1, full_images=False, report=lambda _: None)
    with open_recording(bag) as recording:
        print(f"the demo's bag as {storage.value}, {recording.message_count:,} messages")
        with create_recording(stored, storage=storage, declared_bytes=recording.declared_bytes) as written:
            for message in recording.messages():
                written.write(*message)
    return stored


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
    parser.add_argument("--storage", choices=[one.value for one in Storage], default=Storage.SQLITE3.value)
    parser.add_argument("--seconds", type=float, default=200.0, help="of the demo's mission")
    parser.add_argument("--turns", type=int, default=15, help="at least two")
    arguments = parser.parse_args()
    storage = Storage(arguments.storage)
    copy = partial(plain_copy, storage=storage)
    replayed = partial(replay_mission, storage=storage, budget_kb_per_s=arguments.budget)
    with tempfile.TemporaryDirectory(prefix="testudo-benchmark-") as name:
        folder = Path(name)
        bag = record(folder, arguments.seconds, storage)
        pairs = compare(copy, replayed, bag, folder, arguments.turns)
    print(f"medians of {arguments.turns} pairs, the middle half of the ratios in brackets")
    report("wall time", lambda cost: cost.wall_s, pairs)
    report("CPU time ", lambda cost: cost.cpu_s, pairs)
    print(f"aim: a ratio of the CPU times of at most {AIMS[storage]}")


if __name__ == "__main__":
    main()
