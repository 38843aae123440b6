# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What Prometheus gets over HTTP, and what nobody can do to the run by asking."""

from __future__ import annotations

import builtins
import http.client
import socket
import sys
import urllib.error
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import pytest
from prometheus_client.openmetrics.parser import text_string_to_metric_families as openmetrics
from prometheus_client.parser import text_string_to_metric_families as prometheus_text

from link.openmetrics.scraping import OPENMETRICS, TIMEOUT_S, scraped
from smarttestudo.domain.errors import MissingPackageError, PortError
from smarttestudo.domain.metric import Metric, MetricKind, MetricName
from smarttestudo.link.openmetrics import open_metrics_server
from smarttestudo.link.openmetrics.server import MOST_CLIENTS, MetricsServer

RATE = MetricName(name="t_rate", unit="hertz", help='A "rate".', labels=("topic",))
COUNT = MetricName(name="t", unit="messages", help="A count.", kind=MetricKind.COUNTER)
RULES = MetricName(name="t_rules", help="Words.", kind=MetricKind.INFO, labels=("sha256",))
METRICS = [
    Metric(name=RATE, samples=[(("/odom",), 2.5), (('a "b"\n\\c',), float("inf"))]),
    Metric(name=COUNT, samples=[((), 7.0)]),
    Metric(name=RULES, samples=[(("ab",), 1.0)]),
]


@pytest.fixture
def server() -> Iterator[MetricsServer]:
    server = open_metrics_server("127.0.0.1", 0, lambda: METRICS)
    yield server
    server.close()


@pytest.mark.parametrize(
    ("accept", "kind", "parse"),
    [
        (OPENMETRICS, "application/openmetrics-text", openmetrics),
        ("*/*", "text/plain", prometheus_text),
        ("application/openmetrics-text; version=new", "application/openmetrics-text", openmetrics),
    ],
)
def test_both_formats_say_the_same_numbers(server: MetricsServer, accept: str, kind: str, parse: Any) -> None:
    content_type, body = scraped(server.port, accept)
    assert content_type.startswith(kind)
    found = {
        (sample.name, *sample.labels.values()): sample.value for one in parse(body) for sample in one.samples
    }
    assert found == {
        (RATE.sample_name, "/odom"): 2.5,
        (RATE.sample_name, 'a "b"\n\\c'): float("inf"),
        (COUNT.sample_name,): 7.0,
        (RULES.sample_name, "ab"): 1.0,
    }
    assert (RATE.sample_name, COUNT.sample_name, RULES.sample_name) == (
        "t_rate_hertz",
        "t_messages_total",
        "t_rules_info",
    )


@pytest.mark.parametrize(
    ("method", "path", "status"), [("GET", "/nowhere", 404), ("POST", "/metrics", 501), ("GET", "/", 200)]
)
def test_nothing_else_is_there(server: MetricsServer, method: str, path: str, status: int) -> None:
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=TIMEOUT_S)
    connection.request(method, path)
    assert connection.getresponse().status == status
    connection.close()


def test_a_failure_costs_the_answer_only(capfd: pytest.CaptureFixture[str]) -> None:
    answers = [METRICS]

    def metrics() -> list[Metric]:
        if answers:
            answers.pop()
            raise ValueError("no")
        return METRICS

    server = open_metrics_server("127.0.0.1", 0, metrics)
    with pytest.raises(urllib.error.HTTPError) as refused:
        scraped(server.port)
    assert (refused.value.code, refused.value.read()) == (500, b"error: unexpected ValueError: no\n")
    assert "t_messages_total 7.0" in scraped(server.port)[1]
    server.close()
    assert capfd.readouterr() == ("", "")


def test_clients_that_say_nothing_take_no_more_than_their_places(
    server: MetricsServer, capfd: pytest.CaptureFixture[str]
) -> None:
    silent = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(MOST_CLIENTS)]
    one_more = socket.create_connection(("127.0.0.1", server.port), timeout=TIMEOUT_S)
    assert one_more.recv(1) == b""
    for connection in [*silent, one_more]:
        connection.close()
    answered = None
    while answered is None:
        with suppress(OSError, http.client.HTTPException):
            answered = scraped(server.port)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("host", "remedy"), [("127.0.0.1", "give another port"), ("192.0.2.1", "give an address of this machine")]
)
def test_an_address_that_cannot_be_listened_on_is_said_with_what_to_do(
    server: MetricsServer, host: str, remedy: str
) -> None:
    with pytest.raises(PortError, match=remedy) as refused:
        open_metrics_server(host, server.port, lambda: METRICS)
    assert str(refused.value).startswith(f"{host}:{server.port}: error: metrics cannot be served there: ")


def test_without_the_package_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = builtins.__import__

    def without_prometheus(name: str, *rest: Any, **named: Any) -> Any:
        if name.partition(".")[0] == "prometheus_client":
            raise ModuleNotFoundError(f"No module named {name!r}", name="prometheus_client")
        return usual(name, *rest, **named)

    monkeypatch.delitem(sys.modules, "smarttestudo.link.openmetrics.server", raising=False)
    monkeypatch.setattr(builtins, "__import__", without_prometheus)
    with pytest.raises(MissingPackageError, match=r"prometheus-client; .* -m pip install '\.\[metrics\]'"):
        open_metrics_server("127.0.0.1", 0, lambda: METRICS)
