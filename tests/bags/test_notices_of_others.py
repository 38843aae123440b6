# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Notices of odd recordings give the reason that holds, not one of several."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from bags.bag_factory import ODOM
from bags.odd_definitions import SEPARATOR
from bags.recorded_by_others import (
    ODOMETRY,
    channel,
    chunk,
    drive,
    odometry_at,
    schema,
    text_at,
    write_records,
)
from smarttestudo.bags.measure import measure_bag, measure_run
from smarttestudo.cli.main import main

NAN, INF = float("nan"), float("inf")


def odd_at(number: int, odd: Callable[[int], bytes]) -> bytes:
    """An odd message every second, as places are read five times a second."""
    return odometry_at(number) if number % 10 else odd(number)


@pytest.mark.parametrize(
    ("odd", "why"),
    [
        pytest.param(lambda _: b"", "in an empty message", id="no byte"),
        pytest.param(lambda _: b"\0\1\0\0", "in an empty message", id="a header alone"),
        pytest.param(
            lambda number: odometry_at(number)[:40], "in a message that cannot be decoded", id="cut"
        ),
        pytest.param(lambda number: odometry_at(number, x=NAN), "that is NaN or infinite", id="NaN"),
        pytest.param(lambda number: odometry_at(number, x=INF), "that is NaN or infinite", id="infinite"),
    ],
)
def test_why_a_place_of_the_robot_is_not_known(odd: Callable[[int], bytes], why: str, tmp_path: Path) -> None:
    bag = write_records(
        tmp_path / "a.mcap", *chunk(*ODOMETRY, *drive(payload=lambda number: odd_at(number, odd)))
    )
    run = measure_run(bag, lambda _: None)
    assert run.summary.notices == (f"10 places of the robot not known: 10 {why}",)


def test_a_place_without_its_field_is_said_as_such(tmp_path: Path) -> None:
    text = f"own/P pose\n{SEPARATOR}MSG: own/P\nint64 q\n"
    described = (schema(1, ODOM.type_name, text=text), channel(1, ODOM.name, 1))
    messages = drive(payload=lambda _: b"\0\1\0\0" + bytes(8))
    bag = write_records(tmp_path / "a.mcap", *chunk(*described, *messages), described=described)
    (notice,) = measure_run(bag, lambda _: None).summary.notices
    assert notice == "50 places of the robot not known: 50 without the field that says it"


def test_a_topic_of_two_types_is_said_by_every_table_and_report(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    described = (*ODOMETRY, schema(2, "std_msgs/msg/String"), channel(2, ODOM.name, 2))
    messages = [*drive(), *drive(range(3), payload=text_at, of=2)]
    bag = write_records(tmp_path / "a.mcap", *chunk(*described, *messages), described=described)
    said = (
        f"/odom: recorded with several types, {ODOM.type_name}, std_msgs/msg/String; its numbers are of all "
        "of them"
    )
    assert said in measure_bag(bag, lambda _: None).notices
    page = tmp_path / "page.html"
    assert main(["bag", "report", str(bag), "-o", str(page)]) == 0
    assert f"note: {said}\n" in capsys.readouterr().err
    assert said in page.read_text()
