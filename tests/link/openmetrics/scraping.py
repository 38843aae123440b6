# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a monitoring system reads at an address, by the parser of OpenMetrics."""

from __future__ import annotations

import urllib.request
from collections.abc import Mapping

from prometheus_client.openmetrics.parser import text_string_to_metric_families

OPENMETRICS = "application/openmetrics-text; version=1.0.0"
TIMEOUT_S = 30.0

Samples = dict[tuple[str, frozenset[tuple[str, str]]], float]


def scraped(port: int, accept: str = OPENMETRICS) -> tuple[str, str]:
    """Content type and body of ``/metrics``."""
    request = urllib.request.Request(f"http://127.0.0.1:{port}/metrics", headers={"Accept": accept})
    with urllib.request.urlopen(request, timeout=TIMEOUT_S) as answer:
        return answer.headers["Content-Type"], answer.read().decode()


def samples(port: int) -> tuple[Samples, Mapping[str, str]]:
    """All samples, and the type of each metric by the names of its samples; all have a help."""
    found: Samples = {}
    types = {}
    for family in text_string_to_metric_families(scraped(port)[1]):  # type: ignore[no-untyped-call]
        assert family.documentation, family.name
        for sample in family.samples:
            key = sample.name, frozenset(sample.labels.items())
            assert key not in found
            found[key] = sample.value
            types[sample.name] = family.type
    return found, types


def value(found: Samples, name: str, **labels: str) -> float | None:
    return found.get((name, frozenset(labels.items())))


def require_only_growth(before: Samples, after: Samples, types: Mapping[str, str]) -> int:
    """Fails where a counter fell or is gone; how many there are."""
    counters = {key: number for key, number in before.items() if types[key[0]] == "counter"}
    assert {key for key, number in counters.items() if after.get(key, -1.0) < number} == set()
    return len(counters)
