# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a replay of the demo's recording costs beside a plain copy of it with the same library.

Run it with ``python benchmarks/replay_speed.py``. Both run in turns in one process; the medians are compared.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable
from importlib.resources import as_file, files
from pathlib import Path

from rosbags.rosbag2 import Reader, Writer

from smarttestudo.adapters.rosbag import open_recording
from smarttestudo.composition.demo_mission import record_mission
from smarttestudo.composition.replay import ReplayRequest, replay
from smarttestudo.composition.rule_sets import load_rules

TURNS = 7
SECONDS = 200.0
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


def replay_mission(bag: Path, output: Path) -> None:
    """The thesis's evaluation rules over the bag, from the rule file to the written recording."""
    with as_file(files("smarttestudo.simulation") / "warehouse.adirf") as rule_file:
        rules = load_rules([rule_file])
    with open_recording(bag) as recording:
        replay(ReplayRequest(recording=recording, rule_set=rules.rule_set, output=output))


def seconds_of(work: Callable[[Path, Path], None], bag: Path, output: Path) -> float:
    """How long ``work`` takes."""
    started_s = time.perf_counter()
    work(bag, output)
    return time.perf_counter() - started_s


def main() -> None:
    """Print the medians and their ratio."""
    with tempfile.TemporaryDirectory(prefix="testudo-benchmark-") as folder:
        bag = Path(folder, "mission")
        record_mission(bag, seconds=SECONDS, seed=1, full_images=False, report=lambda _: None)
        taken_s: dict[Callable[[Path, Path], None], list[float]] = {plain_copy: [], replay_mission: []}
        for turn in range(TURNS):
            for work, turns_s in taken_s.items():
                turns_s.append(seconds_of(work, bag, Path(folder, f"{work.__name__}_{turn}")))
        with open_recording(bag) as recording:
            print(f"the demo's bag, {recording.message_count:,} messages; medians of {TURNS} turns")
    copy_s, replay_s = (statistics.median(turns_s) for turns_s in taken_s.values())
    print(f"plain copy  {copy_s:.3f} s")
    print(f"replay      {replay_s:.3f} s")
    print(f"ratio       {replay_s / copy_s:.2f}  (aim: at most {AIM})")


if __name__ == "__main__":
    main()
