# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An operator's view over radios that lose packets: SmartTestudo's two ends beside what others have.

Run it as root with ``python benchmarks/radio_links.py``; a round of all radios takes a quarter of an hour.
Each file in ``benchmarks/thin_link/scenarios`` is a radio; ``--only`` also takes one of your own. Offered is
1.2 times the rate by the size of the JPEG images.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
from pathlib import Path

from smarttestudo.domain.errors import TestudoError
from thin_link.cases import Beside, Case, Seen
from thin_link.measuring import CONTENDERS, measured
from thin_link.network_namespaces import require_links
from thin_link.scenario import load_scenario, scenario_paths
from thin_link.tables import print_ages, print_rates, print_targets


def compare(arguments: argparse.Namespace) -> None:
    """All radios, or some, and what came of them as the tables of docs/contributors/benchmark-link.md."""
    print(f"Load of this machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors", flush=True)
    known = scenario_paths()
    paths = [known.get(one, Path(one)) for one in arguments.only or known]
    cases = [(load_scenario(path).case(Beside(arguments.beside)), str(path)) for path in paths]
    # Two of others would meet at one address.
    everyone = list(CONTENDERS) if arguments.beside == Beside.NOTHING.value else ["testudo"]
    contenders = arguments.contender or everyone
    seen: dict[Case, dict[str, list[Seen]]] = {case: {} for case, _ in cases}
    try:
        for number in range(arguments.rounds):
            for case, traffic in cases:
                for contender in contenders:
                    one = measured(case, traffic, contender, arguments.seconds or case.seconds, number + 1)
                    if one is not None:
                        seen[case].setdefault(contender, []).append(one)
    finally:
        # Whatever ends it, an hour's figures are not lost.
        names = {one: CONTENDERS[one] for one in contenders}
        print_targets(seen, names)
        print_rates(seen, names)
        print_ages(seen, names)


def main() -> None:
    """Compare."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--only", nargs="+", metavar="RADIO", help=f"{', '.join(scenario_paths())}, or the path of a file"
    )
    besides = [one.value for one in Beside]
    parser.add_argument("--beside", choices=besides, default="nothing", help="what else the radio carries")
    parser.add_argument("--contender", nargs="+", choices=CONTENDERS, help="only these")
    parser.add_argument("--rounds", type=int, default=1, help="how often (default: %(default)s)")
    parser.add_argument("--seconds", type=float, help="of a run (default: as the file says, else 20)")
    arguments = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda _number, _frame: sys.exit(1))
    try:
        require_links()
        compare(arguments)
    except TestudoError as error:
        parser.exit(1, f"{error}\n")


if __name__ == "__main__":
    main()
