# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records: dataclasses as JSON and back, as the types of their fields say."""

from smarttestudo.domain.record.codec import entries_of, from_json, measured_names, to_json
from smarttestudo.domain.record.columns import column_types, to_columns
from smarttestudo.domain.record.entry import (
    AtMost,
    Count,
    Decimals,
    JsonEntry,
    Mark,
    Measured,
    Significant,
    derived,
    derived_entry,
    json_name,
    marks,
)

__all__ = [
    "AtMost",
    "Count",
    "Decimals",
    "JsonEntry",
    "Mark",
    "Measured",
    "Significant",
    "column_types",
    "derived",
    "derived_entry",
    "entries_of",
    "from_json",
    "json_name",
    "marks",
    "measured_names",
    "to_columns",
    "to_json",
]
