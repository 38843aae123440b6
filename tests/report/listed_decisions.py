# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Decisions in a report."""

from __future__ import annotations

from pathlib import Path


def listed_decisions(report: Path) -> int:
    """How many decisions the table of a report has."""
    table = report.read_text(encoding="utf-8").partition("Decisions in the order of time")[2]
    return table.partition("<tbody>")[2].partition("</tbody>")[0].count("<tr")
