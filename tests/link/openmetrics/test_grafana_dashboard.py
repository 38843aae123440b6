# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The dashboard asks for metrics that exist, by labels that they have, of any Prometheus."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from link.openmetrics.test_status_metrics import ALL

DASHBOARD = Path(__file__).parents[3] / "extras" / "grafana" / "smarttestudo.json"
FIELDS = json.loads(DASHBOARD.read_text(encoding="utf-8"))
PANELS = [panel for panel in FIELDS["panels"] if panel["type"] != "row"]
VARIABLES = {one["name"]: one for one in FIELDS["templating"]["list"]}
NAMES = {name.sample_name: {*name.labels, "job"} for name in ALL}
OF_ANY = {"type": "prometheus", "uid": "${datasource}"}
COLUMNS = 24
COUNTERS = {name.sample_name for name in ALL if name.sample_name.endswith("_total")}


def queries() -> list[str]:
    asked = [target["expr"] for panel in PANELS for target in panel["targets"]]
    return asked + [one["query"]["query"] for one in VARIABLES.values() if one["type"] == "query"]


@pytest.mark.parametrize("query", queries())
def test_a_query_names_a_metric_that_exists_and_its_labels(query: str) -> None:
    (metric,) = set(re.findall(r"testudo_\w+", query))
    assert metric in NAMES
    filtered = set(re.findall(r"(\w+)=~", query))
    grouped = {label for group in re.findall(r"by \(([^)]*)\)", query) for label in group.split(", ")}
    assert filtered | grouped <= NAMES[metric]
    assert set(re.findall(r"\$(\w+)", query)) <= VARIABLES.keys()
    assert (metric in COUNTERS) == bool(re.search(r"\b(rate|increase)\(", query))


def test_the_data_source_is_chosen_where_it_is_imported() -> None:
    assert VARIABLES["datasource"]["type"] == "datasource"
    targets = [target for panel in PANELS for target in panel["targets"]]
    of_queries = [one for one in VARIABLES.values() if one["type"] == "query"]
    assert all(one["datasource"] == OF_ANY for one in [*PANELS, *targets, *of_queries])


def test_panels_have_a_place_of_their_own_and_say_what_they_show() -> None:
    taken: set[tuple[int, int]] = set()
    for panel in FIELDS["panels"]:
        place: dict[str, Any] = panel["gridPos"]
        cells = {(place["x"] + x, place["y"] + y) for x in range(place["w"]) for y in range(place["h"])}
        assert not cells & taken
        assert max(x for x, _ in cells) < COLUMNS
        assert panel["type"] == "row" or panel["description"].endswith(".")
        taken |= cells
    numbers = [panel["id"] for panel in FIELDS["panels"]]
    assert len(set(numbers)) == len(numbers)
