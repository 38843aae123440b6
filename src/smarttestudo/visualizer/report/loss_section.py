# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the operator lost, beside the best that fixed rates could do with the same bytes."""

from __future__ import annotations

from collections.abc import Iterator

from smarttestudo.visualizer.comparison_tables import RunNames
from smarttestudo.visualizer.loss.report import LossReport
from smarttestudo.visualizer.loss.tables import loss_tables
from smarttestudo.visualizer.report.bars import Bar, bars
from smarttestudo.visualizer.report.html_table import html_table
from smarttestudo.visualizer.report.markup import Markup, tag
from smarttestudo.visualizer.report.sections import section
from smarttestudo.visualizer.summary import fixed_price, length_text, position_error


def loss_section(loss: LossReport, names: RunNames) -> Markup:
    """The error of the position as bars, then fields, ages, crossings and images as tables."""
    explanation = (
        "How far the operator's picture was from the robot, who holds the last message received. Fixed: the "
        "best that rates which never change could have done with the same bytes, a rival that needs no rules."
    )
    tables = (part for table in loss_tables(loss) for part in (tag("h3", table.title), html_table(table)))
    letters = f"In the tables, A is {names.before} and B is {names.after}."
    note = [] if names == RunNames(before="A", after="B") else [tag("p", letters, class_="note")]
    return section("What the operator lost", *_position(loss, names), *note, *tables, explanation=explanation)


def _position(loss: LossReport, names: RunNames) -> Iterator[Markup]:
    error = position_error(loss)
    if error is None:
        return
    arms = ((names.after, error.received_m, "run-after"), ("Best fixed rates", error.fixed_m, "run-before"))
    longest_m = max(error.received_m, error.fixed_m or 0.0)
    yield tag("h3", f"Error of the position in {error.topic} (RMSE)", class_="words")
    yield bars(
        [
            Bar(name=name, value=value, text=length_text(value, beside_m=longest_m), css_class=look)
            for name, value, look in arms
            if value is not None
        ]
    )
    price = fixed_price(loss)
    if price:
        yield tag("p", price, class_="note words")
