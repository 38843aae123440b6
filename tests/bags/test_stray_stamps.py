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

from bags.bag_factory import (
    ODOM,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    write_humble_file,
    write_mcap_file,
)
from bags.recorded_by_others import (
    QOS_IN_WORDS,
    channel,
    chunk,
    drive,
    message,
    odometry_at,
    schema,
    stamp_of,
    text_at,
    write_records,
)
from pacing.reckoning.ros_messages import ODOMETRY, odometry, planar
from replays.replay_runs import replay_bag
from smarttestudo.accuracy.recorded_loss import measure_loss
from smarttestudo.bags.measure import measure_bag, measure_run
from smarttestudo.bags.profile import profile_of_recording
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.statistics import Latency

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


DAY_NS = 86_400 * S
DRIVE = [START_NS + number * S // 10 for number in range(100)]


@pytest.mark.parametrize(
    ("stamps_ns", "left_out", "days"),
    [
        pytest.param([*DRIVE, START_NS + 180 * DAY_NS], 1, 30, id="half a year ahead"),
        pytest.param([START_NS - 180 * DAY_NS, *DRIVE], 1, 30, id="half a year behind"),
        pytest.param([START_NS - 40 * DAY_NS, *DRIVE], 1, 30, id="forty days"),
        pytest.param([0, *DRIVE, START_NS + 180 * DAY_NS], 2, 30, id="stamp 0, too"),
        pytest.param([START_NS + 180 * DAY_NS + one for one in range(11)] + DRIVE, 11, 30, id="a tenth"),
        pytest.param(
            [*DRIVE, *(one + 5 * DAY_NS for one in DRIVE), START_NS + 200 * DAY_NS], 1, 150, id="of days"
        ),
    ],
)
def test_few_stamps_that_are_further_than_all_others_by_far_are_left_out(
    stamps_ns: list[int], left_out: int, days: int, tmp_path: Path
) -> None:
    bag = write_mcap_file(tmp_path / "odd.mcap", content_of(sorted(stamps_ns)))
    found = measure_bag(bag, lambda _: None)
    assert found.total.messages == 2 * (len(stamps_ns) - left_out)
    (notice,) = found.notices
    assert f"more than {days} days from the median" in notice


@pytest.mark.parametrize(
    "stamps_ns",
    [
        pytest.param([one + day * DAY_NS for day in (0, 1, 2, 9) for one in DRIVE], id="nights and a week"),
        pytest.param([*DRIVE, *(one + 60 * DAY_NS for one in DRIVE)], id="two drives"),
        pytest.param(
            [one + 31 * month * DAY_NS for month in range(12) for one in DRIVE[:9]], id="each month"
        ),
        pytest.param([*DRIVE, *(one + 29 * DAY_NS for one in DRIVE[:5])], id="less than a month"),
        pytest.param([START_NS + number * 14 * DAY_NS for number in range(100)], id="a ramp of four years"),
        pytest.param([START_NS + number * DAY_NS // 2 for number in range(6000)], id="a ramp of eight years"),
        pytest.param([START_NS + number * 300 * DAY_NS for number in range(10)], id="a few over years"),
        pytest.param([one + year * YEAR_NS * 2 for year in range(3) for one in DRIVE[:9]], id="three thirds"),
    ],
)
def test_long_recordings_with_pauses_keep_all(stamps_ns: list[int], tmp_path: Path) -> None:
    bag = write_mcap_file(tmp_path / "long.mcap", content_of(stamps_ns))
    found = measure_bag(bag, lambda _: None)
    assert (found.total.messages, found.notices) == (2 * len(stamps_ns), ())


@pytest.mark.parametrize("topic", ["/map", "/tf_static"])
def test_what_was_latched_before_the_clock_is_there_from_the_start(topic: str, tmp_path: Path) -> None:
    latched = QOS_IN_WORDS.replace("volatile", "transient_local") if topic == "/map" else ""
    described = (
        schema(1, ODOM.type_name),
        channel(1, ODOM.name, 1),
        schema(2, "std_msgs/msg/String"),
        channel(2, topic, 2, qos=latched),
    )
    early = [message(0, text_at(1), of=2, log_ns=0), message(0, odometry_at(0), log_ns=0)]
    bag = write_records(tmp_path / "a.mcap", *chunk(*described, *early, *drive()), described=described)
    found = measure_bag(bag, lambda _: None)
    assert (found.statistics[topic].messages, found.statistics[topic].start_s) == (1, 0)
    why = "as their stamps are more than a year from the median (2023-11-14)"
    assert found.notices == (
        f"left out of all numbers, {why}: 1 message of /odom; "
        f"latched, and so held from the start, {why}: 1 message of {topic}",
    )
    run = replay_bag(bag, f"SetFrequency /odom 2\nSetFrequency {topic} Full", tmp_path)
    with open_recording(run.output) as recording:
        (sent,) = [(stamp_ns, data) for one, stamp_ns, data in recording.messages() if one.topic == topic]
    assert sent == (stamp_of(0), text_at(1))
    assert found.notices[0] in run.outcome.notices


def test_a_recording_of_one_time_is_not_read_for_it_and_keeps_all(tmp_path: Path) -> None:
    stamps_ns = [START_NS, START_NS + YEAR_NS - 1]
    found = measure_bag(write_mcap_file(tmp_path / "long.mcap", content_of(stamps_ns)), lambda _: None)
    assert (found.total.messages, found.notices) == (4, ())


@pytest.mark.parametrize(
    ("header_ns", "notices", "mean_s"),
    [
        pytest.param(lambda stamp_ns: stamp_ns - S // 4, (), 0.25, id="one clock"),
        pytest.param(lambda stamp_ns: stamp_ns - 59 * S, (), 59, id="a slow robot"),
        pytest.param(lambda stamp_ns: stamp_ns // (4 * S) * 4 * S, (), 1.65, id="bursts"),
        pytest.param(lambda stamp_ns: stamp_ns + S // 20, (), -0.05, id="clocks as good as one"),
        pytest.param(lambda _: 0, (), None, id="nobody stamps"),
        pytest.param(
            lambda stamp_ns: stamp_ns + S // 4,
            ("the clocks differ: no latency of 50 stamps; 50 after the reception",),
            None,
            id="a clock that is ahead",
        ),
        pytest.param(
            lambda stamp_ns: stamp_ns - 3600 * S,
            ("the clocks differ, or messages waited: no latency of 50 stamps; 50 more than 60 s before it",),
            None,
            id="an hour late",
        ),
        pytest.param(
            lambda stamp_ns: stamp_ns - START_NS + S,
            ("the clocks differ, or messages waited: no latency of 50 stamps; 50 more than 60 s before it",),
            None,
            id="simulated time",
        ),
        pytest.param(
            lambda stamp_ns: stamp_ns - S // 4 - (600 * S if stamp_ns >= START_NS + 2 * S else 0),
            (
                "the clocks differ, or messages waited: its latency is of 20 of 50 stamps; "
                "30 more than 60 s before it",
            ),
            0.25,
            id="a jump back in the middle",
        ),
        pytest.param(
            lambda stamp_ns: stamp_ns - S // 4 + (600 * S if stamp_ns >= START_NS + 2 * S else 0),
            ("the clocks differ: its latency is of 20 of 50 stamps; 30 after the reception",),
            0.25,
            id="a jump ahead in the middle",
        ),
        pytest.param(
            lambda stamp_ns: stamp_ns - S // 4 if stamp_ns // (S // 10) % 2 else 0,
            ("its latency is of 25 of 50 stamps; 25 not set",),
            0.25,
            id="half of them not set",
        ),
        pytest.param(
            lambda stamp_ns: (0, -(2**31) * S, stamp_ns - S // 4, stamp_ns + S, stamp_ns - 61 * S)[
                stamp_ns // (S // 10) % 5
            ],
            (
                "the clocks differ: its latency is of 10 of 50 stamps; "
                "10 not set, 10 after the reception, 20 more than 60 s before it",
            ),
            0.25,
            id="of everything something",
        ),
    ],
)
def test_a_latency_between_two_clocks_is_none(
    header_ns: Callable[[int], int], notices: tuple[str, ...], mean_s: float | None, tmp_path: Path
) -> None:
    bag = write_mcap_file(tmp_path / "bag.mcap", content_of(REGULAR, header_ns=header_ns))
    found = measure_bag(bag, lambda _: None, with_latency=True)
    assert found.notices == tuple(f"/odom, /scan: {notice}" for notice in notices)
    latency = found.topics[0].latency
    assert latency is not None
    assert latency.mean_s == (None if mean_s is None else pytest.approx(mean_s))


def test_a_latched_message_has_no_latency_however_old_it_is(tmp_path: Path) -> None:
    latched = QOS_IN_WORDS.replace("volatile", "transient_local")
    described = (schema(1, ODOM.type_name), channel(1, ODOM.name, 1, qos=latched))
    old = message(0, odometry_at(0, header_ns=stamp_of(0) - 7200 * S))
    bag = write_records(tmp_path / "a.mcap", *chunk(*described, old), described=described)
    found = measure_bag(bag, lambda _: None, with_latency=True)
    assert (found.notices, found.topics[0].latency) == ((), Latency())
