# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of rows about recordings, with the columns that they always have."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum


class ColumnType(Enum):
    """The content of a column; any cell may be missing."""

    TEXT = "text"
    WHOLE = "whole number"
    NUMBER = "number"
    NUMBERS = "list of numbers"
    FLAG = "true or false"
    TIME = "time in UTC"


_TEXT, _WHOLE, _NUMBER = ColumnType.TEXT, ColumnType.WHOLE, ColumnType.NUMBER

OF_EACH_TABLE: Mapping[str, ColumnType] = {
    "run": _TEXT,
    "written_at": ColumnType.TIME,
    "version": _TEXT,
}
"""The columns of every table: which command line wrote the row, when, and which SmartTestudo."""


def _errors(*names: str) -> dict[str, ColumnType]:
    return {
        f"{name}_{way}_{kind}": _NUMBER
        for name in names
        for way in ("hold", "interpolated")
        for kind in ("rmse", "max", "relative_rmse", "relative_max")
    }


class RowTable(Enum):
    """A table by the name of its folder; its columns are those of ``--csv``, and some more."""

    TOPICS = "topics"
    COMPARISONS = "comparisons"
    LOSSES = "losses"
    CURVES = "curves"
    ACCURACIES = "accuracies"
    REPLAYS = "replays"
    REPORTS = "reports"

    @property
    def columns(self) -> Mapping[str, ColumnType]:
        """The columns by name, in their order."""
        return {**OF_EACH_TABLE, **_COLUMNS[self]}


_BAG = {"bag": _TEXT}
_PAIR = {"a": _TEXT, "b": _TEXT}
_COLUMNS: Mapping[RowTable, Mapping[str, ColumnType]] = {
    RowTable.TOPICS: {
        **_BAG,
        "recorded_at": ColumnType.TIME,
        **dict.fromkeys(("topic", "type", "qos"), _TEXT),
        **dict.fromkeys(("messages", "bytes"), _WHOLE),
        **dict.fromkeys(("start_s", "end_s", "mean_hz", "binned_hz", "kb_per_s"), _NUMBER),
        "declared": ColumnType.FLAG,
        **dict.fromkeys(("kbit_per_s", "longest_gap_s", "jitter_s"), _NUMBER),
        **dict.fromkeys(("latency_mean_s", "latency_p95_s", "latency_max_s"), _NUMBER),
    },
    RowTable.COMPARISONS: {
        **_PAIR,
        **dict.fromkeys(("topic", "b_topic"), _TEXT),
        **dict.fromkeys(("a_hz", "b_hz", "change_percent"), _NUMBER),
        **dict.fromkeys(("a_kb_per_s", "b_kb_per_s", "bandwidth_change_percent"), _NUMBER),
    },
    RowTable.LOSSES: {
        **_PAIR,
        **dict.fromkeys(("topic", "field", "unit"), _TEXT),
        "range": _NUMBER,
        **_errors("b", "fixed"),
    },
    RowTable.CURVES: {
        "a": _TEXT,
        **dict.fromkeys(("topic", "field", "unit"), _TEXT),
        **dict.fromkeys(("hz", "kb_per_s"), _NUMBER),
        **{name.removeprefix("_"): of for name, of in _errors("").items()},
    },
    RowTable.ACCURACIES: {
        **_BAG,
        **dict.fromkeys(("name", "shows"), _TEXT),
        "all_bytes": _WHOLE,
        "topic": _TEXT,
        **dict.fromkeys(("messages", "bytes"), _WHOLE),
        **dict.fromkeys(("property", "unit"), _TEXT),
        **dict.fromkeys(("rmse", "worst"), _NUMBER),
        "bounds": ColumnType.NUMBERS,
        "broken": _WHOLE,
    },
    RowTable.REPLAYS: {
        **_BAG,
        **dict.fromkeys(("topic", "monitored_topic"), _TEXT),
        **dict.fromkeys(("in", "out", "repeated"), _WHOLE),
        **dict.fromkeys(("source_hz", "target_hz", "mean_hz", "error_percent", "in_kb", "out_kb"), _NUMBER),
        "declared": ColumnType.FLAG,
        "frames": _WHOLE,
    },
    RowTable.REPORTS: {
        **_PAIR,
        "robot": _TEXT,
        "recorded_at": ColumnType.TIME,
        "duration_s": _NUMBER,
        "topic": _TEXT,
        **dict.fromkeys(("messages", "bytes"), _WHOLE),
        **dict.fromkeys(("received_messages", "received_bytes", "lost_messages"), _WHOLE),
        **dict.fromkeys(("age_mean_s", "age_max_s"), _NUMBER),
    },
}
