# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The option of the commands that Prometheus can watch."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING

from smarttestudo.cli.output import write_line
from smarttestudo.domain.metric import Metric
from smarttestudo.link.openmetrics import open_metrics_server

if TYPE_CHECKING:
    from smarttestudo.robot.part import PartKind

LOOPBACK = "127.0.0.1"
_ADDRESS = re.compile(r"(?:(?P<host>[^\s\[\]:]+|\[[0-9A-Fa-f:.]+\]):)?(?P<port>[0-9]{1,5})", re.ASCII)
_LAST_PORT = 65_535


def add_openmetrics(parser: argparse._ActionsContainer) -> None:
    parser.add_argument(
        "--openmetrics",
        metavar="[HOST:]PORT",
        type=metrics_address,
        help=f"serve metrics for Prometheus there, at /metrics (default host: {LOOPBACK})",
    )


def metrics_address(text: str) -> tuple[str, int]:
    """Host and port from the command line; ``ArgumentTypeError`` for anything else."""
    found = _ADDRESS.fullmatch(text)
    if found is None or int(found["port"]) > _LAST_PORT:
        raise argparse.ArgumentTypeError(
            f"an address is written as in 9464, 0.0.0.0:9464 or [::]:9464, not {text!r}"
        )
    return (found["host"] or LOOPBACK).strip("[]"), int(found["port"])


@contextmanager
def served_metrics(
    address: tuple[str, int] | None, metrics: Callable[[], Iterable[Metric]]
) -> Iterator[None]:
    """Serve ``metrics`` while the block lasts, if there is an ``address``, and say where.

    Raises ``MissingPackageError`` and ``PortError``.
    """
    if address is None:
        yield
        return
    host, port = address
    with closing(open_metrics_server(host, port, metrics)) as server:
        named = f"[{host}]" if ":" in host else host
        write_line(f"Metrics: http://{named}:{server.port}/metrics")
        sys.stdout.flush()
        yield


@contextmanager
def served_run(address: tuple[str, int] | None, robot: str) -> Iterator[Sequence[PartKind]]:
    """The part of a run whose metrics are served, under the name ``robot``; none without an ``address``."""
    if address is None:
        yield ()
        return
    from smarttestudo.link.openmetrics.run_metrics import RunMetrics  # noqa: PLC0415  most runs serve none
    from smarttestudo.robot.part import PartKind  # noqa: PLC0415  an operator's end has no parts

    watched = RunMetrics(robot)
    with served_metrics(address, watched.metrics):
        yield (PartKind(make=lambda _context: watched),)
