# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One process of a comparison, as ``thin_link.ends`` starts it."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from thin_link.cases import CASES
from thin_link.fleet import be_fleet, be_router, be_stuck
from thin_link.limits import TRAFFIC
from thin_link.roles import ENDPOINT, be_flow_sink, be_flow_source, be_operator, be_robot
from thin_link.scenario import load_scenario
from thin_link.traffic import Topic


def topics_of(traffic: str) -> Sequence[Topic]:
    """The topics that the robot sends in the case of that name, or over the radio in that file."""
    if traffic in CASES:
        return CASES[traffic].topics
    return TRAFFIC[traffic] if traffic in TRAFFIC else load_scenario(Path(traffic)).topics


def main() -> None:
    """Be what the command line says until a line, or the end of the input, comes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("role", nargs="+")
    parser.add_argument("--seconds", type=float)
    parser.add_argument("--traffic")
    parser.add_argument("--endpoint", default=ENDPOINT)
    arguments = parser.parse_args()
    match arguments.role:
        case ["robot", contender]:
            topics = topics_of(arguments.traffic)
            be_robot(contender, topics, arguments.seconds, arguments.endpoint)
        case ["operator", contender]:
            be_operator(contender, topics_of(arguments.traffic), arguments.endpoint)
        case ["fleet", count, endpoint]:
            be_fleet(int(count), endpoint)
        case ["router"]:
            be_router()
        case ["stuck"]:
            be_stuck()
        case ["flow-source"]:
            be_flow_source(arguments.seconds)
        case _:
            be_flow_sink()


if __name__ == "__main__":
    main()
