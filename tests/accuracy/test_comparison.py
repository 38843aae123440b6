# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacing.reckoning.ros_messages import ODOMETRY, odometry, planar
from smarttestudo.accuracy.arms import PacedPicture, Receiver, picture_errors
from smarttestudo.accuracy.samples import Message
from smarttestudo.language.properties import gauges_for
from smarttestudo.pacing.reckoning.motion import Twist, Vector3

SECOND_NS = 1_000_000_000
GAUGES = gauges_for(ODOMETRY, ["position"])


def at(t_s: float, x_m: float, speed_m_per_s: float = 0.0) -> Message:
    """An odometry message of a robot on the x axis."""
    stamp_ns = round(t_s * SECOND_NS)
    twist = Twist(Vector3(speed_m_per_s, 0, 0), Vector3(0, 0, 0))
    payload = odometry(stamp_ns + 1, planar(x_m, 0, 0), twist)
    readings = tuple(gauge.read(payload, None, stamp_ns) for gauge in GAUGES)
    return Message(stamp_ns, readings, hash(payload))


def errors_of(
    sent: Sequence[Message], received: Sequence[Message], end_s: float, *, reckons: bool
) -> dict[str, PacedPicture]:
    receiver = Receiver(GAUGES, received, reckons=reckons)
    (errors,) = picture_errors(sent, [receiver], round(end_s * SECOND_NS))
    return errors


def error(
    sent: Sequence[Message], received: Sequence[Message], end_s: float, *, reckons: bool
) -> PacedPicture:
    return errors_of(sent, received, end_s, reckons=reckons)["position"]


def test_errors_count_as_long_as_the_message_that_shows_them() -> None:
    sent = [at(0, 0), at(1, 1), at(3, 2)]

    found = error(sent, sent[:1], 6, reckons=False)

    # Nothing for 1 s, 1 m for 2 s, 2 m for 3 s.
    assert found.rmse == pytest.approx(math.sqrt((2 * 1 + 3 * 4) / 6))
    assert found.worst == 2.0


def test_a_reckoned_picture_moves_with_the_twist_of_its_last_message() -> None:
    sent = [at(t_s, 0.5 * t_s, 0.5) for t_s in range(5)]

    assert error(sent, sent[:1], 5, reckons=True).worst == pytest.approx(0.0, abs=1e-9)
    assert error(sent, sent[:1], 5, reckons=False).worst == 2.0


def test_what_came_before_the_next_message_of_the_source_counts_from_that_one_on() -> None:
    sent = [at(0, 0), at(1, 1), at(2, 2)]
    late = sent[1]._replace(stamp_ns=round(1.5 * SECOND_NS))

    found = error(sent, [sent[0], late], 3, reckons=False)

    assert found.rmse == pytest.approx(math.sqrt((0 + 1 + 1) / 3))


def test_before_anything_is_shown_there_is_no_error() -> None:
    sent = [at(0, 5), at(1, 6), at(2, 7)]

    assert error(sent, sent[1:2], 3, reckons=False) == PacedPicture(
        messages=1, rmse=math.sqrt(1 / 2), worst=1.0, unknown=1
    )
    assert errors_of(sent, [], 3, reckons=False) == {}


PLACES = st.lists(st.tuples(st.integers(1, 50), st.integers(-9, 9), st.booleans()), min_size=1, max_size=30)


@given(PLACES)
def test_the_error_of_holding_is_that_of_the_last_message_that_passed(
    drawn: list[tuple[int, int, bool]],
) -> None:
    """Against the definition, summed message by message; the first one passes."""
    stamps = [0]
    for after_s, _, _ in drawn:
        stamps.append(stamps[-1] + after_s)
    sent = [at(stamp, x_m) for stamp, (_, x_m, _) in zip(stamps, drawn, strict=False)]
    passes = [index == 0 or one[2] for index, one in enumerate(drawn)]

    found = error(
        sent, [one for one, does in zip(sent, passes, strict=True) if does], stamps[-1], reckons=False
    )

    squares, worst, shown = 0.0, 0.0, drawn[0][1]
    for (start, end), (_, x_m, _), does in zip(pairwise(stamps), drawn, passes, strict=True):
        shown = x_m if does else shown
        squares += (end - start) * (x_m - shown) ** 2
        worst = max(worst, abs(x_m - shown))
    assert found.rmse == pytest.approx(math.sqrt(squares / stamps[-1]))
    assert found.worst == worst
