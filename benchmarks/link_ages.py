# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator sees over a thin link: SmartTestudo's two ends beside plain Zenoh and Fast DDS.

Run it as root with ``python benchmarks/link_ages.py``; it takes eighteen minutes. It makes two network
namespaces with a link between them, which a process carries with a queue of 400 ms either way, and removes
them. Zenoh publishes with its priorities, drops what does not fit its queues, and compresses where that
helps. Ages are those of messages that arrived after the first two seconds; the share of the link counts all
headers.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
from collections.abc import Sequence

from thin_link.cases import CASES, Case, Seen, Target
from thin_link.limits import LIMITS, measure_limit
from thin_link.measuring import CONTENDERS, measured
from thin_link.network_namespaces import NetworkError, require_links
from thin_link.tables import print_ages, print_limits, print_rates, print_targets

CHOSEN = ("testudo", "zenoh", "fastdds")


def compare(arguments: argparse.Namespace) -> None:
    """All cases, or one, and what came of them as the tables of docs/contributors/benchmark-link.md."""
    print(f"Load of this machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors", flush=True)
    chosen = [name for name in (*CASES, *LIMITS) if arguments.only in (None, name)]
    contenders = [arguments.contender] if arguments.contender else list(CHOSEN)
    seen: dict[Case, dict[str, list[Seen]]] = {CASES[name]: {} for name in chosen if name in CASES}
    limits: dict[str, list[list[Target]]] = {name: [] for name in chosen if name in LIMITS}
    try:
        for _ in range(arguments.runs):
            run_once(arguments, contenders, seen, limits)
    finally:
        # Whatever ends it, an hour's figures are not lost.
        names = {one: CONTENDERS[one] for one in contenders}
        if seen:
            print_rates(seen, names)
            print_ages(seen, names)
            print_targets(seen, names)
        if limits:
            print_limits({LIMITS[name][0]: runs for name, runs in limits.items() if runs})


def run_once(
    arguments: argparse.Namespace,
    contenders: Sequence[str],
    seen: dict[Case, dict[str, list[Seen]]],
    limits: dict[str, list[list[Target]]],
) -> None:
    """Measure each case and limit once more."""
    for case, brought in seen.items():
        seconds = arguments.minutes * 60 if case.takes_minutes else case.seconds * arguments.longer
        for contender in contenders:
            one = measured(case, name_of(case), contender, seconds)
            if one is not None:
                brought.setdefault(contender, []).append(one)
    for name, runs in limits.items():
        runs.extend(measured_limit(name))


def name_of(case: Case) -> str:
    """The name by which the processes know a case."""
    return next(name for name, one in CASES.items() if one is case)


def measured_limit(name: str) -> list[list[Target]]:
    """One run, if it showed anything."""
    print(LIMITS[name][0], file=sys.stderr)
    try:
        return [measure_limit(name)]
    except NetworkError as error:
        print(error, file=sys.stderr)
        return []


def main() -> None:
    """Compare."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", choices=[*CASES, *LIMITS], help="one case")
    parser.add_argument("--contender", choices=CHOSEN, help="only this one")
    parser.add_argument("--runs", type=int, default=1, help="how often (default: %(default)s)")
    parser.add_argument("--minutes", type=float, default=1.0, help="of the overload (default: %(default)s)")
    parser.add_argument(
        "--longer", type=float, default=1.0, help="times as long, other cases (default: %(default)s)"
    )
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda _number, _frame: sys.exit(1))
    try:
        require_links()
        compare(arguments)
    except NetworkError as error:
        parser.exit(1, f"{error}\n")


if __name__ == "__main__":
    main()
