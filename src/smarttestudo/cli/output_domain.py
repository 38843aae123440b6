# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options that say where the operators are."""

from __future__ import annotations

import argparse

from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.robot import DiscoveryRange, OutputDomain

# The last one whose ports exist.
LAST_DOMAIN = 232


def add_output_domain(parser: argparse.ArgumentParser) -> None:
    """Add ``--output-domain`` and ``--output-discovery``."""
    parser.add_argument(
        "--output-domain",
        metavar="N",
        type=domain_number,
        help="publish into ROS domain N, so that the radio carries nothing but what is relayed",
    )
    parser.add_argument(
        "--output-discovery",
        choices=[discovery.value for discovery in DiscoveryRange],
        help="how far that domain reaches (default: as ROS_AUTOMATIC_DISCOVERY_RANGE says)",
    )


def output_domain(arguments: argparse.Namespace) -> OutputDomain | None:
    """The domain that the command line names; ``UsageError`` for a discovery range without one."""
    discovery = None if arguments.output_discovery is None else DiscoveryRange(arguments.output_discovery)
    if arguments.output_domain is not None:
        return OutputDomain(number=arguments.output_domain, discovery=discovery)
    if discovery is not None:
        raise UsageError(
            "it is about the domain that --output-domain names", place="--output-discovery", remedy="add that"
        )
    return None


def domain_number(text: str) -> int:
    """A domain from the command line; ``ArgumentTypeError`` for anything but 0 … 232."""
    if not (text.isascii() and text.isdigit()) or int(text) > LAST_DOMAIN:
        raise argparse.ArgumentTypeError(f"a ROS domain is a number from 0 to {LAST_DOMAIN}, not {text!r}")
    return int(text)
