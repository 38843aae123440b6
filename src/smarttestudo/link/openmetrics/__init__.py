# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Metrics over HTTP, for Prometheus: the only importer of its client, which must be installed for that."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from smarttestudo.domain.errors import Extra, MissingPackageError, how_to_install
from smarttestudo.domain.metric import Metric

if TYPE_CHECKING:
    from smarttestudo.link.openmetrics.server import MetricsServer


def open_metrics_server(host: str, port: int, metrics: Callable[[], Iterable[Metric]]) -> MetricsServer:
    """Serve at ``host`` and ``port`` what ``metrics`` gives at each request; port 0 takes a free one.

    ``metrics`` is called in other threads. Raises ``MissingPackageError`` and ``PortError``.
    """
    try:
        from smarttestudo.link.openmetrics.server import MetricsServer  # noqa: PLC0415  see above
    except ModuleNotFoundError as error:
        if error.name != "prometheus_client":
            raise
        cause = "--openmetrics needs the package prometheus-client"
        raise MissingPackageError(cause, remedy=how_to_install(Extra.METRICS)) from error
    return MetricsServer(host, port, metrics)
