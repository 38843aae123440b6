# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What ``testudo bag loss`` prints and refuses, from bags whose loss is known."""

from __future__ import annotations

import math
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from rosbags.rosbag2 import StoragePlugin

from accuracy.loss_signals import held_sine_rmse, line_sine_rmse, sine
from bags.bag_factory import (
    CUSTOM_TYPE,
    GRIPPER,
    IMAGE,
    ODOM,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
    odometry,
    write_bag,
    write_humble_file,
)
from report.bag_desk import MISSION, Ran, mission_bags, thinned
from report.golden_files import assert_reads_as
from smarttestudo.accuracy.loss_report import Carried
from smarttestudo.accuracy.recorded_loss import measure_loss
from smarttestudo.cli.main import main
from smarttestudo.report.comparison_tables import RunNames
from smarttestudo.report.document import loss_section
from smarttestudo.report.loss_tables import arms_lines
from smarttestudo.rules.profile_file import load_profile

GOLDEN = Path(__file__).parent / "golden"
S = 1_000_000_000
RULES = """begin
    SetFrequency /odom 5
    If (CheckValue /odom pose_y > 2.5) Then SetFrequency /odom 10
    If (CheckValue /odom rate < 1 OR CheckValue /battery level < 20) Then SetFrequency /odom 1
end
"""


class Desk:
    """A folder with the recordings ``sent`` and ``seen``, one message of five, in which commands are run."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def loss(self, *arguments: str) -> Ran:
        self._capsys.readouterr()
        code = main(["bag", "loss", *arguments])
        captured = self._capsys.readouterr()
        return Ran(code, captured.out, captured.err)

    def refuses(self, *arguments: str, code: int = 1) -> str:
        ran = self.loss(*arguments)
        assert (ran.code, ran.out) == (code, "")
        assert ran.err.count("\n") == 1
        return ran.err.rstrip("\n")


def field_of(ran: Ran, topic: str, name: str) -> Any:
    return next(one for one in ran.json["fields"] if (one["topic"], one["field"]) == (topic, name))


@pytest.fixture
def desk(
    tmp_path: Path,
    tmp_path_factory: pytest.TempPathFactory,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> Desk:
    shutil.copytree(mission_bags(tmp_path_factory), tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rules.adirf").write_text(RULES)
    return Desk(capsys)


def of_floats(values: list[float], *, hz: int, topic: str = "/level", start_ns: int = START_NS) -> BagContent:
    kind = "std_msgs/msg/Float64"
    messages = [
        BagMessage(topic, start_ns + number * S // hz, cdr(kind, message_of(kind, data=value)))
        for number, value in enumerate(values)
    ]
    return BagContent((BagTopic(topic, kind),), tuple(messages))


def test_the_loss_of_a_recorded_sine_is_its_closed_form(desk: Desk, tmp_path: Path) -> None:
    content = of_floats([sine(0.5)(n / 100) for n in range(1001)], hz=100)
    write_bag(tmp_path / "sine", content)
    write_bag(tmp_path / "tenth", thinned(10, "/testudo{}", content), storage=StoragePlugin.MCAP)
    loss = field_of(desk.loss("sine", "tenth", "--json"), "/level", "data")
    step = math.tau * 0.5 / 100
    assert loss["received"]["hold"]["rmse"] == pytest.approx(held_sine_rmse(step, 10), rel=1e-9)
    assert loss["received"]["interpolated"]["rmse"] == pytest.approx(line_sine_rmse(step, 10), rel=1e-9)
    assert loss["range"] == pytest.approx(2, rel=1e-3)


def of_modes(modes: dict[float, str], topic: str) -> BagContent:
    kind = "std_msgs/msg/String"
    messages = [
        BagMessage(topic, START_NS + round(at_s * S), cdr(kind, message_of(kind, data=mode)))
        for at_s, mode in modes.items()
    ]
    return BagContent((BagTopic(topic, kind),), tuple(messages))


def test_a_text_is_wrong_for_as_long_as_the_operator_believed_another(desk: Desk, tmp_path: Path) -> None:
    modes = {0.0: "idle", 10.0: "docking", 10.4: "idle", 20.0: "docking", 30.0: "x" * 2_000_000}
    seen = {1.0: "idle", 12.0: "idle", 23.0: "docking", 29.0: "docking"}
    write_bag(tmp_path / "modes", of_modes(modes, "/mode"))
    write_bag(tmp_path / "seen modes", of_modes(seen, "/testudo/mode"))
    (tmp_path / "modes.adirf").write_text(
        'begin If (CheckValue /mode data = "docking") Then SetFrequency /mode 2 end'
    )
    ran = desk.loss("modes", "seen modes", "--rules", "modes.adirf", "--json")
    (crossing,) = ran.json["crossings"]
    assert (crossing["check"], crossing["crossings"]) == ('/mode data = "docking"', 4)
    # Unknown for 1 s, wrong for 0.4 s, and from 20 to 23 s; at 30 s, the end, it becomes so again.
    assert crossing["received"]["wrong_s"] == pytest.approx(4.4)
    assert crossing["received"]["missed"] == 3
    assert ran.json["fields"] == []
    ran = desk.loss("modes", "seen modes", "--rules", "modes.adirf")
    assert "Wrong is for how long" in ran.out
    assert max(map(len, ran.out.splitlines())) <= 120


@pytest.mark.parametrize(("fixed_bytes", "is_said"), [(100, False), (125, False), (170, True)])
def test_fixed_rates_that_took_more_than_what_was_received_are_said(
    desk: Desk, fixed_bytes: int, is_said: bool
) -> None:
    carried = Carried(sent_bytes=500, received_bytes=100, fixed_bytes=fixed_bytes)
    report = replace(measure_loss(Path("sent"), Path("seen")), carried=carried)
    said = [line for line in arms_lines(report) if line.startswith("Fixed took 1.7 times the bytes of B: ")]
    assert bool(said) == is_said
    html = str(loss_section(report, RunNames(before="A", after="B")))
    assert all(line in html for line in said)
    assert ("the bytes of B:" in html) == is_said


def test_nothing_is_lost_between_a_recording_and_itself(desk: Desk) -> None:
    ran = desk.loss("sent", "sent", "--rules", "rules.adirf", "--json")
    assert {topic["fixed_hz"] for topic in ran.json["topics"].values()} == {None}
    for loss in ran.json["fields"]:
        for arm in ("received", "fixed"):
            assert {size["max"] for size in loss[arm].values()} == {0}
    for topic in ran.json["topics"].values():
        assert topic["sent"] == topic["received"] == topic["fixed"]
    for loss in ran.json["crossings"]:
        assert loss["received"]["in_time"] == loss["fixed"]["in_time"] == loss["crossings"] == 1
    assert len(set(ran.json["bytes"].values())) == 1


def test_the_tables_and_curves_read_as_in_the_golden_files(desk: Desk) -> None:
    ran = desk.loss("sent", "seen", "--rules", "rules.adirf")
    assert ran.code == 0
    assert ran.err == "note: /battery: a check reads it, which seen lacks; its crossings are left out\n"
    assert_reads_as(GOLDEN / "bag-loss.txt", ran.out)
    assert max(map(len, ran.out.splitlines())) <= 100
    ran = desk.loss("sent")
    assert ran.code == 0
    assert ran.err == (
        "note: /image: of a sensor_msgs/msg/Image no field is looked at unless --field names it, so there is "
        "no curve\nnote: /map_name: only one message, so there is no curve\n"
    )
    assert_reads_as(GOLDEN / "bag-loss-curves.txt", ran.out)


def test_a_robot_at_constant_speed_is_off_by_what_it_drove_since(desk: Desk) -> None:
    pose = field_of(desk.loss("sent", "seen", "--json"), "/odom", "pose_y")
    squares = [(number % 5 / 25) ** 2 for number in range(99)]
    assert pose["received"]["hold"]["rmse"] == pytest.approx(math.sqrt(sum(squares) / 99))
    assert pose["received"]["hold"]["max"] == pytest.approx(4 / 25)
    assert pose["unit"] == "m"


def test_images_are_counted_and_never_decoded(desk: Desk, tmp_path: Path) -> None:
    broken = tuple(
        replace(message, payload=b"no image") if message.topic == IMAGE.name else message
        for message in MISSION.messages
    )
    write_bag(tmp_path / "broken", BagContent(MISSION.topics, broken))
    ran = desk.loss("broken", "seen", "--json")
    assert ran.err == ""
    (image,) = ran.json["images"]
    assert (image["sent"]["frames"], image["received"]["frames"]) == (20, 4)
    assert image["sent"]["longest_blind_s"] == pytest.approx(0.2)
    assert image["received"]["longest_blind_s"] == pytest.approx(1)


def test_topics_and_fields_are_chosen_by_name(desk: Desk) -> None:
    ran = desk.loss(
        "sent", "seen", "--topics", "/grip*", "--field", "/scan", "ranges[0]", "range_min", "--csv"
    )
    assert [(row["topic"], row["field"]) for row in ran.csv] == [
        ("/gripper", "opening"),
        ("/scan", "distance"),
        ("/scan", "ranges[0]"),
        ("/scan", "range_min"),
    ]
    ranges, range_min = ran.csv[-2:]
    # Beyond the 9 m that the scans state, ranges are not known.
    assert (ranges["range"], ranges["b_hold_max"]) == ("8.0", "4.0")
    assert (range_min["range"], range_min["b_hold_rmse"], range_min["b_hold_relative_rmse"]) == (
        "0.0",
        "0.0",
        "",
    )


def test_values_that_are_no_numbers_are_left_out_and_counted(desk: Desk, tmp_path: Path) -> None:
    values = [0.0, math.nan, 1.0, math.inf, 1.0, 1.0]
    write_bag(tmp_path / "holes", of_floats(values, hz=1))
    write_bag(tmp_path / "first", of_floats(values[:2], hz=1))
    ran = desk.loss("holes", "first", "--json")
    loss = field_of(ran, "/level", "data")
    assert (loss["excluded_sent"], loss["excluded_received"]) == (2, 1)
    # Of 5 s, one second each is unknown to NaN and inf; in two of the other three the value held is wrong.
    assert loss["received"]["hold"]["rmse"] == pytest.approx(math.sqrt(2 / 3))
    assert "Left out, as no value is known: /level data 2 in A, 1 in B." in desk.loss("holes", "first").out


def test_a_type_that_nobody_defines_is_counted_and_not_decoded(desk: Desk, tmp_path: Path) -> None:
    write_humble_file(tmp_path / "humble.db3", MISSION)
    ran = desk.loss("humble.db3", "seen", "--json")
    why = f"neither the recording nor ROS 2 defines {CUSTOM_TYPE}"
    assert ran.err == f"note: /gripper: 20 messages not decoded: {why}\n"
    assert "/gripper" in ran.json["topics"]
    assert all(loss["topic"] != GRIPPER.name for loss in ran.json["fields"])


def test_messages_that_cannot_be_decoded_are_counted(desk: Desk, tmp_path: Path) -> None:
    broken = BagMessage(ODOM.name, MISSION.messages[-1].stamp_ns, b"\x00\x01\x00\x00")
    write_bag(tmp_path / "broken", BagContent(MISSION.topics, (*MISSION.messages, broken)))
    ran = desk.loss("broken", "seen", "--json")
    assert ran.err == "note: /odom: 1 message could not be decoded and was left out\n"
    assert field_of(ran, "/odom", "pose_y")["excluded_sent"] == 1


FLOAT, TEXT = "std_msgs/msg/Float64", "std_msgs/msg/String"


@pytest.mark.parametrize(
    ("type_name", "payloads", "why"),
    [
        (FLOAT, [], "/odd: no message"),
        (FLOAT, [{"data": 1.0}], "/odd: only one message"),
        (FLOAT, [{"data": 1.0}] * 3, "/odd: no field changes"),
        (FLOAT, [{"data": math.nan}] * 3, "/odd: no message has a number that is known"),
        (TEXT, [{"data": "a"}, {"data": "b"}], "/odd: no field is a number"),
        (FLOAT, [b"\0\1\0\0"] * 3, "/odd: 3 messages could not be decoded and were left out"),
        ("own_msgs/msg/Own", [b"\0\1\0\0"], "/odd: 1 message not decoded: neither the recording nor ROS 2"),
    ],
)
def test_why_a_topic_has_no_curve_is_said_once(
    desk: Desk, tmp_path: Path, type_name: str, payloads: list[Any], why: str
) -> None:
    messages = [
        BagMessage(
            "/odd",
            START_NS + number * S,
            one if isinstance(one, bytes) else cdr(type_name, message_of(type_name, **one)),
        )
        for number, one in enumerate(payloads)
    ]
    drive = [BagMessage("/odom", START_NS + n * S, odometry(3.0 * n, 4.0 * n)) for n in range(5)]
    content = BagContent(
        (ODOM, BagTopic("/odd", type_name)), tuple(sorted([*drive, *messages], key=lambda one: one.stamp_ns))
    )
    write_humble_file(tmp_path / "odd.db3", content)
    ran = desk.loss("odd.db3", "--json")
    (notice,) = ran.json["notices"]
    assert notice.startswith(why)
    assert ran.err == f"note: {notice}\n"


def test_a_topic_of_two_types_is_compared_by_age_only(desk: Desk, tmp_path: Path) -> None:
    level = of_floats([1.0, 2.0, 3.0], hz=1)
    kind = "std_msgs/msg/Int32"
    ints = [BagMessage("/level", START_NS, cdr(kind, message_of(kind, data=1)))]
    write_bag(tmp_path / "floats", level)
    write_bag(tmp_path / "ints", BagContent((BagTopic("/level", kind),), tuple(ints)))
    ran = desk.loss("floats", "ints", "--json")
    assert field_of(ran, "/level", "data")["received"] is None
    assert ran.json["topics"]["/level"]["received"]["age"]["max_s"] == 2
    assert ran.err == (
        "note: /level: std_msgs/msg/Float64 in floats and std_msgs/msg/Int32 in ints; "
        "its fields are not compared\n"
    )


def test_the_curve_at_a_rate_is_the_loss_of_a_replay_at_that_rate(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "five.adirf").write_text("begin SetFrequency /odom 5 SetFrequency /scan 2 end")
    assert main(["replay", "sent", "--rules", "five.adirf", "--output", "replayed"]) == 0
    curves = desk.loss("sent", "--json").json["topics"]
    ran = desk.loss("sent", "replayed", "--json")
    for topic, field, hz in (("/odom", "pose_y", 5), ("/scan", "distance", 2)):
        point = next(point for point in curves[topic]["points"] if point["hz"] == hz)
        error = {key: value for key, value in point["fields"][field].items() if key != "unit"}
        assert error == field_of(ran, topic, field)["received"]
        assert point["age"] == ran.json["topics"][topic]["received"]["age"]


def test_a_position_is_off_by_the_distance_of_what_is_held(desk: Desk, tmp_path: Path) -> None:
    drive = [BagMessage("/odom", START_NS + n * S, odometry(3.0 * n, 4.0 * n)) for n in range(5)]
    write_bag(tmp_path / "drive", BagContent((ODOM,), tuple(drive)))
    write_bag(tmp_path / "start", BagContent((ODOM,), tuple(drive[:1])))
    report = measure_loss(tmp_path / "drive", tmp_path / "start")
    assert report.position_rmse_m("/odom") == pytest.approx(5 * math.sqrt((0 + 1 + 4 + 9) / 4))
    assert report.position_rmse_m("/scan") is None


def test_a_recording_in_pieces_is_read_as_far_as_it_goes(desk: Desk, tmp_path: Path) -> None:
    path = next((tmp_path / "seen").glob("*.db3"))
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 69 // 100])
    ran = desk.loss("sent", "seen", "--json")
    assert ran.code == 0
    assert ran.err.startswith(f"note: {Path('seen', path.name)}: cut off: 69 % readable, ends at ")


def test_a_topic_of_which_nothing_was_received_has_no_numbers(desk: Desk, tmp_path: Path) -> None:
    scans_only = [message for message in MISSION.messages if message.topic == "/scan"]
    write_bag(tmp_path / "scans", BagContent(MISSION.topics, tuple(scans_only)))
    ran = desk.loss("sent", "scans", "--json")
    assert field_of(ran, "/odom", "pose_y")["received"] is None
    assert ran.json["topics"]["/odom"]["received"] == {"messages": 0, "bytes": 0, "age": None}
    assert desk.loss("sent", "scans").code == 0


def test_a_topic_of_which_nothing_was_sent_is_named(desk: Desk, tmp_path: Path) -> None:
    silent = BagTopic("/alarm", "std_msgs/msg/String")
    for name in ("a", "b"):
        write_bag(tmp_path / name, BagContent((*MISSION.topics, silent), MISSION.messages))
    ran = desk.loss("a", "b", "--topics", "/odom", "/alarm", "--json")
    assert list(ran.json["topics"]) == ["/odom"]
    assert ran.err == "note: /alarm: a holds no message of it, so there is no loss to measure\n"


def test_a_recording_that_ends_early_is_said(desk: Desk, tmp_path: Path) -> None:
    write_bag(tmp_path / "short", MISSION.between(0, 40))
    ran = desk.loss("sent", "short", "--json")
    assert ran.err.startswith("note: short: ends 3.")
    assert ran.err.endswith(" s before sent; nothing came in that time\n")


def test_a_recording_that_begins_late_is_said(desk: Desk, tmp_path: Path) -> None:
    late = [message for message in MISSION.messages if message.stamp_ns >= START_NS + 3 * 10**9]
    write_bag(tmp_path / "late", BagContent(MISSION.topics, tuple(late)))
    ran = desk.loss("sent", "late", "--topics", "/odom", "--json")
    unseen_s = ran.json["topics"]["/odom"]["received"]["age"]["unseen_s"]
    assert unseen_s >= 3
    assert ran.err == (
        f"note: /odom: nothing received in the first {unseen_s:.1f} s; errors and ages count from then\n"
    )


def test_recordings_that_cannot_be_compared_are_refused_in_one_line(desk: Desk, tmp_path: Path) -> None:
    write_bag(tmp_path / "other", of_floats([1.0], hz=1))
    write_bag(
        tmp_path / "later", BagContent((ODOM,), (BagMessage("/odom", START_NS + 99 * S, odometry(0, 0)),))
    )
    refusals = {
        ("sent", "nowhere"): "nowhere: error: no such file or folder; "
        "give a rosbag2 folder, a .db3 or an .mcap file",
        ("sent", "other"): "other: error: it has no topic in common with sent; pair two by --map /a=/b",
        ("sent", "later"): "later: error: it has no time in common with sent; "
        "give two recordings of one run; `testudo replay` makes the second from the first",
        ("sent", "seen", "--topics", "/odmo"): "sent, seen: error: no topic /odmo; did you mean /odom?",
        ("sent", "seen", "--field", "/odmo", "x"): "sent: error: no topic /odmo; did you mean /odom?",
        (
            "sent",
            "seen",
            "--field",
            "/gripper",
            "width",
        ): "/gripper: error: no message has a number at width; it has opening, holds",
        ("sent", "--field", "/gripper", "width"): "/gripper: error: no message has a number at width; "
        "name a numeric field by its path",
    }
    for arguments, refusal in refusals.items():
        assert desk.refuses(*arguments) == refusal


def test_wrong_usage_is_refused_in_one_line(desk: Desk) -> None:
    refusals = {
        ("sent", "seen", "--field", "odom"): "--field: error: odom is no topic with fields; "
        "write it as in /odom pose_x twist.twist.linear.x",
        ("sent", "seen", "--field", "/odom", "rate"): "--field: error: rate is not a field but how messages "
        "arrive; msg.rate is a field of that name",
        ("sent", "seen", "--field", "/odom", "a b"): "--field: error: 'a b' is not a field; "
        "write it as in twist.twist.linear.x or ranges[0]",
        ("sent", "--rules", "rules.adirf"): "--rules: error: it needs a second recording; "
        "give what the operator received as B",
        ("sent", "--map", "/a=/b"): "--map: error: it needs a second recording; "
        "give what the operator received as B",
    }
    for arguments, refusal in refusals.items():
        assert desk.refuses(*arguments, code=2) == refusal


def test_a_profile_from_the_curve_has_its_breakpoints_as_tiers(desk: Desk, tmp_path: Path) -> None:
    assert main(["profile", "--bag", "sent", "--from-curve", "-o", "p.toml"]) == 0
    topics = desk.loss("sent", "--json").json["topics"]
    profile = load_profile(tmp_path / "p.toml")
    for name in ("/odom", "/scan", "/gripper"):
        assert profile.topic(name).tiers_hz == tuple(topics[name]["tiers_hz"])
    text = (tmp_path / "p.toml").read_text(encoding="utf-8")
    assert "  # RMSE of holding: 20, 10, 5, 2, 1 % of the range (worst: pose_y), 0 at source_hz\n" in text
    assert profile.topic("/image").tiers_hz == (0.25, 0.5, 1.25, 2.5, 4, 5)
    assert "  # 5, 10, 25, 50, 80, 100 % of source_hz\n" in text
