# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages whose stamps are of another time, and headers that another clock stamped."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags.bag_factory import START_NS, BagContent, BagMessage, BagTopic, write_humble_file, write_mcap_file
from pacing.reckoning.ros_messages import ODOMETRY, odometry, planar
from replays.replay_runs import replay_bag
from smarttestudo.accuracy.recorded_loss import measure_loss
from smarttestudo.bags.measure import measure_bag, measure_run
from smarttestudo.bags.profile import profile_of_recording
from smarttestudo.bags.reader import open_recording

S = 1_000_000_000
YEAR_NS = 366 * 86_400 * S
REGULAR = [START_NS + number * S // 10 for number in range(50)]
TOPICS = tuple(BagTopic(name, ODOMETRY) for name in ("/odom", "/scan"))
WRITERS: dict[str, Callable[[Path, BagContent], Path]] = {"mcap": write_mcap_file, "db3": write_humble_file}


def content_of(stamps_ns: Sequence[int], *, header_ns: Callable[[int], int] = lambda _: 1) -> BagContent:
    """Both topics at each stamp, with the robot 5 cm further on each time."""
    return BagContent(
        TOPICS,
        tuple(
            BagMessage(topic.name, stamp_ns, odometry(header_ns(stamp_ns), planar(number / 20, 0, 0)))
            for number, stamp_ns in enumerate(stamps_ns)
            for topic in TOPICS
        ),
    )


@pytest.mark.parametrize("storage", WRITERS)
@pytest.mark.parametrize(
    ("stamps_ns", "left_out"),
    [
        pytest.param([0, 0, 0, *REGULAR], 3, id="before the clock"),
        pytest.param([*REGULAR[:20], START_NS + 9 * YEAR_NS, *REGULAR[20:]], 1, id="one in the future"),
        pytest.param([*REGULAR, 2**63 - 1], 1, id="the last stamp there is"),
        pytest.param([0, *REGULAR, START_NS + 2 * YEAR_NS], 2, id="both sides"),
        pytest.param(
            [stamp_ns - START_NS for stamp_ns in REGULAR] + REGULAR, 50, id="the later of two halves"
        ),
    ],
)
def test_stamps_of_another_time_change_no_number_and_are_said(
    storage: str, stamps_ns: list[int], left_out: int, tmp_path: Path
) -> None:
    write = WRITERS[storage]
    bag = write(tmp_path / f"bag.{storage}", content_of(stamps_ns))
    odd = measure_bag(bag, lambda _: None)
    assert {topic.name: topic.statistics.mean_hz for topic in odd.topics} == {"/odom": 10.0, "/scan": 10.0}
    assert odd.span.duration_s == pytest.approx(4.9)
    assert odd.readable_share == 1
    messages = "1 message" if left_out == 1 else f"{left_out} messages"
    assert odd.notices == (
        "left out of all numbers, as their stamps are more than a year from the median (2023-11-14): "
        f"{messages} of /odom, {left_out} of /scan",
    )
    run = replay_bag(bag, "SetFrequency /odom 2", tmp_path)
    assert run.outcome.duration_s == pytest.approx(4.9)
    assert odd.notices[0] in run.outcome.notices
    loss = measure_loss(bag, run.output)
    assert loss.topics[0].sent.messages == 50
    assert loss.duration_s == pytest.approx(4.9)
    assert odd.notices[0] in loss.notices
    assert measure_run(bag, lambda _: None).summary.notices == odd.notices
    with open_recording(bag) as recording:
        assert "source_hz = 10" in profile_of_recording(recording, name="bag")


@pytest.mark.parametrize("storage", WRITERS)
@settings(max_examples=20)
@given(
    st.lists(st.integers(0, 10**6), min_size=4, max_size=12),
    st.lists(st.tuples(st.sampled_from([-1, 1]), st.integers(2, 40), st.integers(0, 10**6)), max_size=3),
)
def test_all_numbers_are_those_of_the_recording_without_them(
    storage: str, after_ms: list[int], strays: list[tuple[int, int, int]]
) -> None:
    regular = sorted(START_NS + one * 1_000_000 for one in after_ms)
    odd = sorted([*regular, *(START_NS + way * years * YEAR_NS + one for way, years, one in strays)])
    with tempfile.TemporaryDirectory() as folder:
        write = WRITERS[storage]
        found = measure_bag(write(Path(folder) / f"odd.{storage}", content_of(odd)), lambda _: None)
        usual = measure_bag(write(Path(folder) / f"usual.{storage}", content_of(regular)), lambda _: None)
    assert (found.topics, found.span) == (usual.topics, usual.span)
    assert len(found.notices) == bool(strays)


def test_a_recording_of_one_time_is_not_read_for_it_and_keeps_all(tmp_path: Path) -> None:
    stamps_ns = [START_NS, START_NS + YEAR_NS - 1]
    found = measure_bag(write_mcap_file(tmp_path / "long.mcap", content_of(stamps_ns)), lambda _: None)
    assert (found.total.messages, found.notices) == (4, ())


@pytest.mark.parametrize(
    ("header_ns", "notices", "mean_s"),
    [
        pytest.param(lambda stamp_ns: stamp_ns - S // 4, (), 0.25, id="one clock"),
        pytest.param(lambda stamp_ns: stamp_ns + S // 4, (), -0.25, id="a clock that is ahead"),
        pytest.param(
            lambda stamp_ns: stamp_ns - START_NS + S,
            (
                "/odom, /scan: the clocks differ: header.stamp is of another clock than the reception, "
                "as simulated time or the time since a start, so there is no latency",
            ),
            None,
            id="simulated time",
        ),
        pytest.param(
            lambda stamp_ns: 1 if stamp_ns < START_NS + S else stamp_ns - S // 4,
            (
                "/odom: the clocks differ in 10 of 50 messages, which are left out of its latency",
                "/scan: the clocks differ in 10 of 50 messages, which are left out of its latency",
            ),
            0.25,
            id="before the clock was there",
        ),
    ],
)
def test_a_latency_between_two_clocks_is_none(
    header_ns: Callable[[int], int], notices: tuple[str, ...], mean_s: float | None, tmp_path: Path
) -> None:
    bag = write_mcap_file(tmp_path / "bag.mcap", content_of(REGULAR, header_ns=header_ns))
    found = measure_bag(bag, lambda _: None, with_latency=True)
    assert found.notices == notices
    latency = found.topics[0].latency
    assert latency is not None
    assert latency.mean_s == (None if mean_s is None else pytest.approx(mean_s))
