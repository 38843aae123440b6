# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What recording incidents costs a robot of 1.3 MB/s, and how soon an incident is there.

Run it with ``python benchmarks/incident_cost.py`` where ROS 2 is installed; it takes 40 minutes, less with
``--minutes``. Four runtimes with the same rates are measured one after the other: one without ``Record``; one
that keeps the last minute of all topics; one whose memory holds a third of it; and, for half an hour, one
that has the rest on disk. All but the first have an incident every so often. Then a plain rclpy recorder of
the same topics (``live/roles.py``).

The age of relayed messages is that at the operator's. The memory that the ring takes is what is resident
beyond the first runtime's. An incident is there when its folder is.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from live.cases import IMU_BYTES, IMU_TYPE, Topic
from live.contenders import TESTUDO, role
from live.processes import Process, environment, p99, processes
from live_cost import hears

DOMAIN = 73
SETTLE_S = 5.0
TIMEOUT_S = 30.0
BEFORE_S = 60.0
AFTER_S = 1.0
SAMPLE_S = 5.0
MB = 1e6
TOPICS = [
    Topic(name="/imu", type=IMU_TYPE, hz=195, target_hz=10, size_bytes=IMU_BYTES),
    Topic(name="/odom", type="nav_msgs/msg/Odometry", hz=25.5, target_hz=10, size_bytes=724),
    Topic(name="/joint_states", type="sensor_msgs/msg/JointState", hz=30, target_hz=3, size_bytes=150),
    Topic(name="/scan", type="sensor_msgs/msg/LaserScan", hz=5, target_hz=3, size_bytes=2_940),
    Topic(
        name="/camera/image_raw/compressed",
        type="sensor_msgs/msg/CompressedImage",
        hz=20,
        target_hz=3,
        size_bytes=60_000,
    ),
]
ALARM = Topic(name="/alarm", type="std_msgs/msg/Float64", hz=1, target_hz=1, size_bytes=8)


@dataclass(frozen=True, kw_only=True)
class Run:
    """One process: CPU in percent of a core, the most that was resident, ages, seconds to incidents."""

    cpu_percent: float
    resident_mb: float
    p99_ms: float
    incident_s: Sequence[float]
    incident_mb: float


def rules(folder: Path, before_s: float) -> Path:
    """Rates of all topics, and a recording while the alarm is on, if ``before_s`` is not 0."""
    record = (
        f'Record "alarm" Before {before_s:g} s After {AFTER_S:g} s' if before_s else "SetFrequency /scan 3"
    )
    rates = [f"SetFrequency {topic.name} {topic.target_hz:g}" for topic in TOPICS]
    block = f"If CheckValue /alarm data > 0.5 Then {record} EndIf"
    path = folder / "rules.adirf"
    path.write_text("\n".join(["begin", *rates, block, "end"]), encoding="utf-8")
    return path


def runtime(folder: Path, before_s: float, memory_mb: float, *, with_disk: bool = False) -> list[str]:
    """The command of a runtime that records into ``folder``, where ``with_disk`` keeps what memory cannot."""
    options = ["--incidents", str(folder / "incidents"), "--incident-memory", f"{memory_mb:g}"]
    options += ["--incident-ring", str(folder / "ring")] if with_disk else []
    command = [sys.executable, "-c", TESTUDO, "run", "--rules", str(rules(folder, before_s))]
    return [*command, *(options if before_s else [])]


@dataclass(frozen=True, kw_only=True)
class Station:
    """What stands around the process that is measured."""

    source: Process
    operator: Process
    alarm: Process
    settings: dict[str, str]


@contextmanager
def station(domain: int) -> Iterator[Station]:
    """Sources, an operator, and what triggers incidents."""
    settings = environment(domain, large_messages=False)
    around = [role("source", TOPICS), role("operator", TOPICS), role("alarm", [ALARM])]
    with processes(around, settings) as (source, operator, alarm):
        yield Station(source=source, operator=operator, alarm=alarm, settings=settings)


def incident_s(alarm: Process, folder: Path) -> float:
    """Have an incident begin; the seconds from the end of its window until its folder is there."""
    known = names(folder)
    alarm.ask("0")
    time.sleep(0.3)
    start_s = float(alarm.ask("1"))
    while names(folder) == known:
        if time.monotonic() > start_s + TIMEOUT_S:
            raise TimeoutError(f"no incident within {TIMEOUT_S:.0f} s")
        time.sleep(0.005)
    return time.monotonic() - start_s - AFTER_S


def names(folder: Path) -> set[str]:
    """The incidents that are whole."""
    return {path.name for path in folder.glob("[!.]*")} if folder.exists() else set()


def measure(
    around: Station,
    command: Sequence[str],
    seconds: float,
    *,
    every_s: float = 0.0,
    folder: Path | None = None,
    relays: bool = True,
) -> Run:
    """One process for ``seconds``, once it is settled and ``relays``, with an incident ``every_s``."""
    with processes([command], around.settings) as (process,):
        around.operator.ask("forget")
        if relays and not hears(around.operator, TOPICS):
            raise SystemExit("nothing is relayed")
        time.sleep(SETTLE_S)
        around.operator.ask("forget")
        cpu_s, start_s = process.cpu_s, time.monotonic()
        next_s, resident_mb, found = start_s + every_s, 0.0, []
        while time.monotonic() < start_s + seconds:
            time.sleep(min(SAMPLE_S, seconds))
            resident_mb = max(resident_mb, process.resident_mb)
            if folder is not None and time.monotonic() >= next_s:
                found.append(incident_s(around.alarm, folder))
                next_s += every_s
        used_s, span_s = process.cpu_s - cpu_s, time.monotonic() - start_s
        ages_us = around.operator.ask("ages")
    last = max(folder.glob("[!.]*")) if found and folder is not None else None
    return Run(
        cpu_percent=100 * used_s / span_s,
        resident_mb=resident_mb,
        p99_ms=p99(ages_us) / 1000,
        incident_s=found,
        incident_mb=0.0 if last is None else sum(file.stat().st_size for file in last.iterdir()) / MB,
    )


def report(plain: Run, whole: Run, short: Run, disk: Run, *, recorder: Run, short_mb: float) -> None:
    """The figures beside their targets."""
    took_mb, with_disk_mb = (one.resident_mb - plain.resident_mb for one in (short, disk))
    ring_percent = whole.cpu_percent - plain.cpu_percent
    most_mb = 1.05 * short_mb
    print("\n| | measured | target |\n| --- | ---: | ---: |")
    print(f"| p99 of the age, without, ms | {plain.p99_ms:.2f} | |")
    print(f"| memory of the ring, MB, of {short_mb:.0f} | {took_mb:.1f} | ≤ {most_mb:.1f} |")
    print(f"| memory, rest on disk, MB, of {short_mb:.0f} | {with_disk_mb:.1f} | ≤ {most_mb:.1f} |")
    for where, one in (("memory", whole), ("disk", disk)):
        print(f"| incidents, from {where} | {len(one.incident_s)} | |")
        print(f"| one of them, MB | {one.incident_mb:.1f} | |")
        print(f"| window's end to closed file, the longest, s | {max(one.incident_s):.2f} | ≤ 1 |")
        print(f"| p99 of the age, ms | {one.p99_ms:.2f} | |")
        print(f"| ratio | {one.p99_ms / plain.p99_ms:.2f} | ≤ 1.2 |")
    print(f"| CPU with disk, % | {disk.cpu_percent:.1f} | |")
    print(f"| CPU without, % | {plain.cpu_percent:.1f} | |")
    print(f"| CPU with, % | {whole.cpu_percent:.1f} | |")
    print(f"| CPU of a plain recorder, % | {recorder.cpu_percent:.1f} | |")
    print(f"| CPU of the ring, of that | {ring_percent / recorder.cpu_percent:.2f} | ≤ 0.5 |", flush=True)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="What recording incidents costs.")
    parser.add_argument("--minutes", type=float, default=30.0, help="length of the run with a ring on disk")
    parser.add_argument("--domain", type=int, default=DOMAIN, help="a ROS domain that nobody uses")
    arguments = parser.parse_args()
    seconds = 60 * arguments.minutes
    others_s = min(seconds, 120.0)
    rate_mb = sum(topic.hz * topic.size_bytes for topic in TOPICS) / MB
    short_mb = round(rate_mb * min(BEFORE_S, others_s) / 3, 1)
    with tempfile.TemporaryDirectory() as name, station(arguments.domain) as around:
        plain_folder, whole_folder, short_folder, disk_folder = (
            Path(name, one) for one in ("plain", "whole", "short", "disk")
        )
        for folder in (plain_folder, whole_folder, short_folder, disk_folder):
            folder.mkdir()
        time.sleep(SETTLE_S)
        plain = measure(around, runtime(plain_folder, 0, 1), others_s)

        def recording(folder: Path, memory_mb: float, length_s: float, *, with_disk: bool = False) -> Run:
            command = runtime(folder, BEFORE_S, memory_mb, with_disk=with_disk)
            return measure(around, command, length_s, every_s=others_s / 3, folder=folder / "incidents")

        whole = recording(whole_folder, 256, others_s)
        short = recording(short_folder, short_mb, others_s)
        disk = recording(disk_folder, short_mb, seconds, with_disk=True)
        recorder = measure(around, role("plain_recorder", TOPICS), others_s, relays=False)
    report(plain, whole, short, disk, recorder=recorder, short_mb=short_mb)


if __name__ == "__main__":
    main()
