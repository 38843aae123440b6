# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The README's table of throttle accuracy keeps its claim."""

from __future__ import annotations

import runpy
from pathlib import Path

BENCHMARK = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "throttle_accuracy.py"))


def test_our_column_is_exact_to_one_message_of_sixty_seconds() -> None:
    for row in BENCHMARK["accuracies"]():
        for mean_hz in row.ours_hz.values():
            assert abs(mean_hz - row.target_hz) * BENCHMARK["SECONDS"] <= 1


def test_the_gate_is_wrong_in_the_way_the_table_says() -> None:
    without_jitter = {(row.source_hz, row.target_hz): row.gate_hz[0] for row in BENCHMARK["accuracies"]()}
    assert abs(without_jitter[30, 20] - 15) < 0.01
    assert abs(without_jitter[10, 8] - 5) < 0.01
    assert abs(without_jitter[25.5, 10] - 8.5) < 0.01


def test_the_table_is_the_same_on_every_run() -> None:
    table = BENCHMARK["table"](BENCHMARK["accuracies"]())
    assert table == BENCHMARK["table"](BENCHMARK["accuracies"]())
    assert "| 30 → 20 | 15.00 |" in table
