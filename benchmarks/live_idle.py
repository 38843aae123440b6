# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Costs of ``testudo run`` beside another checkout of it: at rest, and a message at eight topics.

Run it with ``python benchmarks/live_idle.py --beside FOLDER`` where ROS 2 is installed; FOLDER is the ``src``
of the other one. At rest, the eight topics of a TurtleBot3 have publishers that send, and no operator
listens: so nothing is subscribed to. The two checkouts take turns, ``--rounds`` times each.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from pathlib import Path

from live.cases import CASES
from live.contenders import role, smarttestudo
from live.processes import Process, environment, processes
from live_cost import TIMEOUT_S, hears

DOMAIN = 73
SETTLE_S = 5.0
TOPICS = CASES["eight, without the raw image"]
RULES = Path(__file__).parents[1] / "examples" / "warehouse.adirf"
HERE = Path(__file__).parents[1] / "src"


def at_rest(source: Path, seconds: float, domain: int) -> float:
    """CPU in % of a core while nobody listens."""
    used_s, _ = window(source, seconds, domain, is_heard=False)
    return 100 * used_s / seconds


def a_message(source: Path, seconds: float, domain: int) -> float:
    """CPU in µs for each message that the sources sent while an operator listens."""
    used_s, sent = window(source, seconds, domain, is_heard=True)
    return used_s * 1e6 / sent


def a_message_with_rules(source: Path, seconds: float, domain: int) -> float:
    """The same with rules that read the pose of ``/odom``."""
    used_s, sent = window(source, seconds, domain, is_heard=True, rules=RULES)
    return used_s * 1e6 / sent


def window(
    source: Path, seconds: float, domain: int, *, is_heard: bool, rules: Path | None = None
) -> tuple[float, int]:
    """The runtime's CPU time in ``seconds``, and how many messages were sent meanwhile."""
    settings = environment(domain, large_messages=False)
    around = [role("source", TOPICS), role("operator", TOPICS if is_heard else [])]
    with tempfile.TemporaryDirectory() as folder, processes(around, settings) as (sources, operator):
        commands = smarttestudo()(TOPICS, Path(folder))
        if rules is not None:
            commands[0][commands[0].index("--rules") + 1] = str(rules)
        with processes(commands, settings | {"PYTHONPATH": path_of(source, settings)}) as (runtime,):
            if is_heard and not hears(operator, TOPICS):
                sys.exit("the operator hears nothing")
            wait_for(operator)
            time.sleep(SETTLE_S)
            sent, cpu_s = sources.ask("sent"), runtime.cpu_s
            time.sleep(seconds)
            return runtime.cpu_s - cpu_s, sources.ask("sent") - sent


def wait_for(operator: Process) -> None:
    """Wait until the runtime offers all its output topics."""
    end_s = time.monotonic() + TIMEOUT_S
    while operator.ask("endpoints smarttestudo")[1] < len(TOPICS):
        if time.monotonic() > end_s:
            sys.exit("the runtime does not start")
        time.sleep(0.2)


def path_of(source: Path, settings: dict[str, str]) -> str:
    """The PYTHONPATH by which the checkout is found before any other."""
    return ":".join(filter(None, (str(source), settings.get("PYTHONPATH"))))


def report(what: str, readings: dict[Path, list[float]]) -> None:
    """Print what was measured of each checkout, and the ratio of the medians."""
    for source, values in readings.items():
        print(f"{what}  {source}: " + ", ".join(f"{value:.2f}" for value in values))
    medians = [statistics.median(values) for values in readings.values()]
    if len(medians) > 1:
        print(
            f"{what}  ratio of the medians: {medians[0] / medians[1]:.2f}, difference: "
            f"{medians[0] - medians[1]:+.2f}",
            flush=True,
        )


MEASURES = {
    "% of a core at rest": at_rest,
    "µs a message": a_message,
    "µs a message, rules read /odom": a_message_with_rules,
}


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="What testudo run costs at rest.")
    parser.add_argument("--beside", type=Path, help="the src folder of another checkout")
    parser.add_argument("--seconds", type=float, default=60.0, help="length of each window")
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--domain", type=int, default=DOMAIN, help="a ROS domain that nobody uses")
    arguments = parser.parse_args()
    sources = [HERE, *([arguments.beside.resolve()] if arguments.beside else [])]
    for what, measure in MEASURES.items():
        readings: dict[Path, list[float]] = {source: [] for source in sources}
        for _ in range(arguments.rounds):
            for source in sources:
                readings[source].append(measure(source, arguments.seconds, arguments.domain))
        report(what, readings)


if __name__ == "__main__":
    main()
