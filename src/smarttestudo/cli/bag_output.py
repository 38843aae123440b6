# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How the actions of ``testudo bag`` print."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterable, Mapping

from smarttestudo.cli.tables import print_table
from smarttestudo.visualizer.table import Table


def print_tables(tables: Iterable[Table]) -> None:
    """Tables below each other, an empty line between."""
    for number, table in enumerate(tables):
        if number:
            print()  # noqa: T201
        print_table(table)


def print_json(value: object) -> None:
    """One object on one line."""
    print(json.dumps(value, allow_nan=False))  # noqa: T201


def print_csv(rows: Iterable[Mapping[str, object]]) -> None:
    """Rows with the same keys, under a line of them."""
    writer: csv.DictWriter[str] | None = None
    for row in rows:
        if writer is None:
            writer = csv.DictWriter(sys.stdout, fieldnames=list(row), lineterminator="\n")
            writer.writeheader()
        writer.writerow(row)


def print_notices(notices: Iterable[str]) -> None:
    """What was lost or odd, on standard error, after what was printed."""
    sys.stdout.flush()
    for notice in notices:
        print(f"note: {notice}", file=sys.stderr)  # noqa: T201
