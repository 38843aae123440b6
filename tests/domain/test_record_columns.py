# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import Enum
from typing import Annotated, Any

import pytest

from smarttestudo.domain.record import JsonEntry, column_types, to_columns


class View(Enum):
    HOLD = "hold"


@dataclass(frozen=True, slots=True, kw_only=True)
class Size:
    rmse: float
    maximum: Annotated[float | None, JsonEntry(name="max")] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    topic: str
    view: Annotated[View, JsonEntry(name="shows")] = View.HOLD
    recorded_at: datetime | None = None
    bounds: tuple[float, ...] = ()
    hold: Size | None = None
    merged: Annotated[Size | None, JsonEntry(is_merged=True)] = None
    unread: Annotated[int, JsonEntry(is_absent=True)] = 0
    more: Mapping[str, int] = field(default_factory=dict)


def test_each_field_is_a_column_of_its_type_and_those_of_records_within_are_flat() -> None:
    assert column_types(Row) == {
        "topic": str,
        "shows": str,
        "recorded_at": datetime,
        "bounds": tuple[float, ...],
        "hold_rmse": float,
        "hold_max": float,
        "rmse": float,
        "max": float,
    }


_ALWAYS = {"topic": "/odom", "shows": "hold", "recorded_at": None}


@pytest.mark.parametrize(
    ("row", "expected"),
    [
        (Row(topic="/odom"), {**_ALWAYS, "bounds": [], "hold_rmse": None, "hold_max": None}),
        (
            Row(topic="/odom", bounds=(1.0,), hold=Size(rmse=2.0), merged=Size(rmse=3.0, maximum=4.0)),
            {**_ALWAYS, "bounds": [1.0], "hold_rmse": 2.0, "hold_max": None, "rmse": 3.0, "max": 4.0},
        ),
    ],
    ids=["nothing-within", "all"],
)
def test_a_row_has_the_columns_of_its_type_but_for_those_of_a_merged_record_that_is_missing(
    row: Row, expected: dict[str, Any]
) -> None:
    assert to_columns(row) == expected
    assert [name for name in column_types(Row) if name in expected] == list(expected)
