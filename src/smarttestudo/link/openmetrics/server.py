# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A small HTTP server in threads of its own, which never makes the run wait."""

from __future__ import annotations

import errno
import socket
import threading
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from prometheus_client import CollectorRegistry, exposition
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, InfoMetricFamily
from prometheus_client.core import Metric as MetricFamily
from prometheus_client.openmetrics import exposition as openmetrics_exposition
from prometheus_client.registry import Collector

from smarttestudo.domain.errors import PortError, said
from smarttestudo.domain.metric import Metric, MetricKind

MOST_CLIENTS = 8
"""Requests that are answered at a time; further connections are closed at once."""
CLIENT_TIMEOUT_S = 5.0
_PATHS = frozenset({"/", "/metrics"})
_OPENMETRICS = "application/openmetrics-text"
_END_WITHIN_S = 5.0

Metrics = Callable[[], Iterable[Metric]]


class MetricsServer:
    """Answers ``GET /metrics`` until it is closed. Raises ``PortError`` where it cannot listen."""

    def __init__(self, host: str, port: int, metrics: Metrics) -> None:
        registry = CollectorRegistry()
        registry.register(_Families(metrics))
        try:
            family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
            self._server = _Server(family, (host, port), partial(_Handler, registry))
        except (OSError, UnicodeError) as error:
            why = error.strerror if isinstance(error, OSError) else None
            is_host = isinstance(error, socket.gaierror | UnicodeError) or _is_foreign(error)
            remedy = "give an address of this machine" if is_host else "give another port"
            cause = f"metrics cannot be served there: {why or error}"
            raise PortError(cause, place=f"{host}:{port}", remedy=remedy) from error
        self._thread = threading.Thread(target=self._server.serve_forever, name="metrics", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        return int(self._server.server_address[1])

    def close(self) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join(_END_WITHIN_S)


def _is_foreign(error: Exception) -> bool:
    return isinstance(error, OSError) and error.errno == errno.EADDRNOTAVAIL


class _Families(Collector):
    """Metrics as those of the client's library."""

    def __init__(self, metrics: Metrics) -> None:
        self._metrics = metrics

    def collect(self) -> Iterator[MetricFamily]:
        for metric in self._metrics():
            yield _family(metric)

    def describe(self) -> list[MetricFamily]:
        """No metrics: none are collected before a request comes."""
        return []


def _family(metric: Metric) -> MetricFamily:
    name = metric.name
    if name.kind is MetricKind.INFO:
        info = InfoMetricFamily(name.name, name.help)
        for values, _ in metric.samples:
            info.add_metric((), dict(zip(name.labels, values, strict=True)))
        return info
    kind = CounterMetricFamily if name.kind is MetricKind.COUNTER else GaugeMetricFamily
    numbers = kind(name.name, name.help, labels=name.labels, unit=name.unit)
    for values, number in metric.samples:
        numbers.add_metric(values, number)
    return numbers


class _Server(ThreadingHTTPServer):
    """At most ``MOST_CLIENTS`` threads, none of which keeps the process from its end."""

    daemon_threads = True
    block_on_close = False

    def __init__(self, family: int, address: tuple[str, int], handler: Callable[..., Any]) -> None:
        self.address_family = family
        self._free = threading.BoundedSemaphore(MOST_CLIENTS)
        super().__init__(address, handler)

    def server_bind(self) -> None:
        """Bind without asking a name server for this machine's name."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind(self.server_address)
        self.server_address = self.socket.getsockname()
        self.server_port = int(self.server_address[1])

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer in a thread, if one is free."""
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that went away or was too slow costs its own answer only."""


class _Handler(BaseHTTPRequestHandler):
    timeout = CLIENT_TIMEOUT_S

    def __init__(self, registry: CollectorRegistry, *connection: Any) -> None:
        self._registry = registry
        super().__init__(*connection)

    def do_GET(self) -> None:
        """Answer with all metrics, in OpenMetrics if the client knows it."""
        if self.path.partition("?")[0] not in _PATHS:
            self._answer(404, "text/plain; charset=utf-8", b"metrics are at /metrics\n")
            return
        knows_openmetrics = _OPENMETRICS in self.headers.get("Accept", "")
        way: Any = openmetrics_exposition if knows_openmetrics else exposition
        try:
            body = way.generate_latest(self._registry)
        except Exception as error:  # noqa: BLE001 - whatever fails here, the run goes on
            self._answer(500, "text/plain; charset=utf-8", f"{said(error)}\n".encode())
            return
        self._answer(200, way.CONTENT_TYPE_LATEST, body)

    def version_string(self) -> str:
        return "SmartTestudo"

    def log_message(self, *_: Any) -> None:
        """Requests are not logged: there is one every few seconds."""

    def _answer(self, status: int, content_type: str, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", content_type)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)
