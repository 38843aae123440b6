# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What ``testudo bag`` prints and refuses, and that its numbers are those of a naive count."""

from __future__ import annotations

import itertools
import json
import math
import shutil
import statistics
import struct
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

import pytest
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from bags.bag_factory import (
    GRIPPER,
    KINDS,
    ODOM,
    SCAN,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    odometry,
    write_bag,
    write_humble_file,
    write_split_bag,
)
from bags.bag_reading import read_with_rosbags
from report.bag_desk import MISSION, Desk, mission_bags, thinned
from report.golden_files import assert_reads_as

GOLDEN = Path(__file__).parent / "golden"
BAG_EXPECTED = "give a rosbag2 folder, a .db3 or an .mcap file"


@pytest.fixture
def desk(
    tmp_path: Path,
    tmp_path_factory: pytest.TempPathFactory,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> Desk:
    shutil.copytree(mission_bags(tmp_path_factory), tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return Desk(capsys)


def naive_numbers(messages: list[BagMessage]) -> dict[str, dict[str, float | None]]:
    first_ns, last_ns = messages[0].stamp_ns, messages[-1].stamp_ns
    stamps, sizes = defaultdict(list), Counter[str]()
    for message in messages:
        stamps[message.topic].append(message.stamp_ns)
        sizes[message.topic] += len(message.payload)
    return {
        topic: {
            "messages": len(times),
            "bytes": sizes[topic],
            "start_s": (times[0] - first_ns) / 1e9,
            "end_s": (times[-1] - first_ns) / 1e9,
            "mean_hz": (len(times) - 1) / (times[-1] - times[0]) * 1e9 if len(times) > 1 else None,
            "binned_hz": len(times) / len(range(times[0] // 10**9, times[-1] // 10**9 + 1)),
            "kb_per_s": sizes[topic] / 1000 / (last_ns - first_ns) * 1e9,
            "longest_gap_s": max(gaps) / 1e9 if (gaps := intervals(times)) else None,
            "jitter_s": statistics.pstdev(gaps) / 1e9 if len(gaps) > 1 else None,
        }
        for topic, times in stamps.items()
    }


def intervals(times: list[int]) -> list[int]:
    return [after - before for before, after in itertools.pairwise(times)]


def assert_same_numbers(ours: dict[str, Any], naive: dict[str, dict[str, float | None]]) -> None:
    assert ours.keys() == naive.keys()
    for topic, expected in naive.items():
        for key, value in expected.items():
            if value is None:
                assert ours[topic][key] is None
            else:
                assert math.isclose(ours[topic][key], value, rel_tol=1e-9, abs_tol=1e-12), (topic, key)


@pytest.mark.parametrize("files", [1, 3])
@pytest.mark.parametrize(("storage", "compression"), KINDS)
def test_the_numbers_are_those_of_a_naive_count(
    desk: Desk, tmp_path: Path, storage: StoragePlugin, compression: CompressionMode, files: int
) -> None:
    size = -(-len(MISSION.messages) // files)
    parts = [MISSION.between(size * i, size * (i + 1)) for i in range(files)]
    folder = write_split_bag(tmp_path / "split", parts, storage=storage, compression=compression)
    naive = naive_numbers(list(MISSION.messages))
    if compression is CompressionMode.NONE:
        assert naive == naive_numbers(read_with_rosbags(folder))
    ran = desk.bag("rates", "split", "--json")
    assert (ran.code, ran.err) == (0, "")
    assert_same_numbers(ran.json["topics"], naive)
    total = ran.json["total"]
    assert total["messages"] == len(MISSION.messages)
    assert total["bytes"] == sum(len(message.payload) for message in MISSION.messages)
    assert math.isclose(total["kbit_per_s"], 8 * total["bytes"] / 1000 / ran.json["duration_s"])


def test_the_tables_read_as_in_the_golden_files(desk: Desk, tmp_path: Path) -> None:
    write_bag(tmp_path / "relayed", thinned(5, "/testudo{}"))
    write_bag(tmp_path / "late", BagContent((ODOM, GRIPPER), tuple(stamped(ODOM, [1, 2, 9]))))
    commands = {
        "info": "info bag",
        "rates": "rates bag",
        "bandwidth": "bandwidth bag",
        "compare": "compare sent relayed",
        "latency": "rates late --latency",
    }
    for name, command in commands.items():
        ran = desk.bag(*command.split())
        assert (ran.code, ran.err) == (0, "")
        assert_reads_as(GOLDEN / f"bag-{name}.txt", ran.out)


def test_declared_sizes_count_and_are_labelled(desk: Desk) -> None:
    topics = desk.bag("bandwidth", "bag", "--json").json["topics"]
    assert topics["/image"]["bytes"] == 20 * 6_220_000
    assert {name for name, topic in topics.items() if topic["declared"]} == {"/image"}


@pytest.mark.parametrize("hours_later", [0, 5])
def test_silence_in_the_time_of_the_first_run_counts_as_bandwidth_of_nothing(
    desk: Desk, *, hours_later: int
) -> None:
    stamps_ns = [START_NS + number * 100_000_000 for number in range(101)]
    full = [BagMessage("/odom", stamp_ns, odometry(0, 0)) for stamp_ns in stamps_ns]
    shift_ns = hours_later * 3600 * 10**9
    thin = [BagMessage(one.topic, one.stamp_ns + shift_ns, one.payload) for one in full[30:41]]
    write_bag(Path("full"), BagContent((ODOM,), tuple(full)))
    write_bag(Path("thin"), BagContent((ODOM,), tuple(thin)))
    ran = desk.bag("compare", "full", "thin", "--json")
    size_kb = len(full[0].payload) / 1000
    # Of another time, it is a run of its own.
    over_s = 1 if hours_later else 10
    assert ran.json["topics"]["/odom"]["b"]["kb_per_s"] == pytest.approx(11 * size_kb / over_s)
    assert ran.json["total"]["b"]["kb_per_s"] == pytest.approx(11 * size_kb / over_s)
    told = "note: thin: lasts 1.0 s; its KB/s count over the 10.0 s of full\n"
    assert ran.err == ("" if hours_later else told)
    assert desk.bag("report", "full", "thin", "--output", "report.html").out.startswith(
        f"report.html: {'+9' if hours_later else '−89'} % bandwidth"
    )


@pytest.mark.parametrize("rename", ["{}", "/testudo{}", "{}_receive"])
def test_topics_pair_with_their_relays(desk: Desk, tmp_path: Path, rename: str) -> None:
    write_bag(tmp_path / "b", thinned(5, rename))
    compared = desk.bag("compare", "sent", "b", "--json").json
    a, b = (desk.bag("rates", bag, "--json").json["topics"] for bag in ("sent", "b"))
    odom = compared["topics"]["/odom"]
    relay = b[rename.format("/odom")]
    assert odom["b_topic"] == rename.format("/odom")
    assert odom["change_percent"] == 100 * (relay["binned_hz"] / a["/odom"]["binned_hz"] - 1)
    assert odom["a"].items() <= a["/odom"].items()
    over_s = desk.bag("info", "sent", "--json").json["duration_s"]
    kb_per_s = relay["bytes"] / 1000 / over_s
    assert odom["b"] == {key: relay[key] for key in odom["b"]} | {
        "kb_per_s": kb_per_s,
        "kbit_per_s": 8 * kb_per_s,
    }


def test_a_mapping_pairs_topics_of_any_name(desk: Desk, tmp_path: Path) -> None:
    write_bag(tmp_path / "b", thinned(5, "/robot{}"))
    assert desk.refuses("compare", "sent", "b") == (
        "b: error: it has no topic in common with sent; pair two by --map /a=/b"
    )
    ran = desk.bag("compare", "sent", "b", "--map", "/odom=/robot/odom", "--csv")
    paired = {row["topic"]: row["b_topic"] for row in ran.csv}
    assert paired["/odom"] == "/robot/odom"
    assert paired["/scan"] == ""
    assert paired["/robot/scan"] == "/robot/scan"


def test_a_source_recorded_beside_its_relay_hides_no_pair(desk: Desk, tmp_path: Path) -> None:
    relayed = thinned(5, "/testudo{}")
    both = sorted([*MISSION.messages, *relayed.messages], key=lambda message: message.stamp_ns)
    write_bag(tmp_path / "b", BagContent((*MISSION.topics, *relayed.topics), tuple(both)))
    topics = desk.bag("compare", "sent", "b", "--json").json["topics"]
    messages = desk.bag("info", "sent", "--json").json["topics"]["/odom"]["messages"]
    assert (topics["/odom"]["a"]["messages"], topics["/odom"]["b_topic"]) == (messages, "/testudo/odom")
    assert (topics["/odom (B)"]["a"], topics["/odom (B)"]["b_topic"]) == (None, "/odom")
    rows = desk.bag("compare", "sent", "b", "--topics", "/odom", "--csv").csv
    assert [row["topic"] for row in rows] == ["/odom", "/odom (B)"]


def test_the_sum_of_a_comparison_is_over_the_topics_shown(desk: Desk) -> None:
    total = desk.bag("compare", "sent", "seen", "--topics", "/odom", "/scan", "--json").json["total"]
    a, b = (desk.bag("rates", bag, "--topics", "/odom", "/scan", "--json").json for bag in ("sent", "seen"))
    kb_per_s = b["total"]["bytes"] / 1000 / a["duration_s"]
    assert total["a"] == a["total"]
    assert total["b"] == {
        **b["total"],
        "kb_per_s": pytest.approx(kb_per_s),
        "kbit_per_s": pytest.approx(8 * kb_per_s),
    }


def test_topics_are_chosen_by_name_and_by_pattern(desk: Desk) -> None:
    ran = desk.bag("rates", "bag", "--json", "--topics", "/odom", "/*ap*")
    assert list(ran.json["topics"]) == ["/map_name", "/odom"]


def test_a_topic_that_is_not_there_is_refused_with_the_nearest(desk: Desk) -> None:
    nearest = "error: no topic /odmo; did you mean /odom?"
    for action in ("info", "rates", "bandwidth"):
        assert desk.refuses(action, "bag", "--topics", "/odmo") == f"bag: {nearest}"
    assert desk.refuses("compare", "sent", "seen", "--topics", "/odmo") == f"sent, seen: {nearest}"
    assert desk.refuses("compare", "sent", "seen", "--map", "/scan=/odmo") == f"seen: {nearest}"
    listed = "error: no topic /zzz*; `testudo bag info` lists them"
    assert desk.refuses("rates", "bag", "--topics", "/zzz*") == f"bag: {listed}"


def test_several_bags_are_shown_one_after_the_other(desk: Desk, tmp_path: Path) -> None:
    write_bag(tmp_path / "b", thinned(5), storage=StoragePlugin.MCAP)
    names = ("sent", "b")
    both = [json.loads(line) for line in desk.bag("rates", *names, "--json").out.splitlines()]
    assert both == [desk.bag("rates", bag, "--json").json for bag in names]
    assert [bag["storage"] for bag in both] == ["sqlite3", "mcap"]
    rows = desk.bag("rates", *names, "--csv").csv
    assert [(row["bag"], row["topic"]) for row in rows] == [
        (bag, topic) for bag in names for topic in sorted(topic.name for topic in MISSION.topics)
    ]
    tables = [desk.bag("rates", bag).out for bag in names]
    assert desk.bag("rates", *names).out.startswith("\n".join(tables))


def test_a_topic_without_messages_is_shown_without_numbers(desk: Desk, tmp_path: Path) -> None:
    write_bag(tmp_path / "one", BagContent(MISSION.topics, MISSION.messages[:1]))
    topics = desk.bag("rates", "one", "--json").json["topics"]
    assert topics["/scan"]["messages"] == 0
    assert (
        topics["/scan"]["mean_hz"] is topics["/scan"]["longest_gap_s"] is topics["/scan"]["start_s"] is None
    )


def stamped(topic: BagTopic, latencies_ms: list[int], *, endian: str = "<") -> list[BagMessage]:
    """Messages with a header, received as late as given."""
    encapsulation = b"\x00\x01\x00\x00" if endian == "<" else b"\x00\x00\x00\x00"
    messages = []
    for number, latency_ms in enumerate(latencies_ms):
        sent_ns = START_NS + number * 10_000_000
        stamp = struct.pack(f"{endian}iI", *divmod(sent_ns, 10**9))
        payload = encapsulation + stamp + bytes(400)
        messages.append(BagMessage(topic.name, sent_ns + latency_ms * 1_000_000, payload))
    return messages


@pytest.mark.parametrize(("storage", "compression"), KINDS)
@pytest.mark.parametrize("endian", "<>")
def test_latency_is_receive_time_minus_the_stamp_in_the_header(
    desk: Desk, tmp_path: Path, storage: StoragePlugin, compression: CompressionMode, endian: str
) -> None:
    latencies_ms = [3, *range(1, 101), -2]
    messages = [
        *stamped(ODOM, latencies_ms, endian=endian),
        BagMessage(ODOM.name, START_NS, odometry(0.0, 0.0)),  # its stamp was never set
        BagMessage(GRIPPER.name, START_NS, stamped(ODOM, [0])[0].payload),
    ]
    messages.sort(key=lambda message: message.stamp_ns)
    content = BagContent((ODOM, SCAN, GRIPPER), tuple(messages))
    write_bag(tmp_path / "late", content, storage=storage, compression=compression)
    plain = desk.bag("rates", "late", "--json").json["topics"]
    topics = desk.bag("rates", "late", "--latency", "--json").json["topics"]
    odom = topics["/odom"]
    assert math.isclose(odom["latency_mean_s"], statistics.mean(latencies_ms) / 1000, rel_tol=1e-12)
    assert odom["latency_p95_s"] == sorted(latencies_ms)[math.ceil(0.95 * len(latencies_ms)) - 1] / 1000
    assert odom["latency_max_s"] == 0.1
    assert topics["/scan"]["latency_mean_s"] is topics["/gripper"]["latency_max_s"] is None
    assert {name: {**topic, **plain[name]} for name, topic in topics.items()} == topics
    assert "latency_mean_s" not in plain["/odom"]


def test_types_that_nobody_defines_are_counted_and_named(desk: Desk, tmp_path: Path) -> None:
    write_humble_file(tmp_path / "humble.db3", MISSION)
    for action in ("info", "rates", "bandwidth"):
        ran = desk.bag(action, "humble.db3", "--json")
        assert ran.json["topics"]["/gripper"]["messages"] == 20
        assert ran.json["notices"] == [
            "/gripper: neither the recording nor ROS 2 defines robot_msgs/msg/Gripper; "
            "its messages are counted, but cannot be decoded"
        ]


@pytest.mark.parametrize("has_metadata", [True, False])
@pytest.mark.parametrize("storage", StoragePlugin)
def test_the_share_of_a_split_bag_counts_all_its_files(
    desk: Desk, tmp_path: Path, storage: StoragePlugin, has_metadata: bool
) -> None:
    parts = [MISSION.between(0, 60), MISSION.between(60, 120), MISSION.between(120, 161)]
    folder = write_split_bag(tmp_path / "split", parts, storage=storage)
    assert desk.bag("info", "split", "--json").json["readable_percent"] == 100
    second = sorted(path for path in folder.iterdir() if path.name != "metadata.yaml")[1]
    second.write_bytes(second.read_bytes()[: second.stat().st_size // 2])
    if not has_metadata:
        (folder / "metadata.yaml").unlink()
    ran = desk.bag("info", "split")
    read = desk.bag("info", "split", "--json").json
    if has_metadata:
        share = read["total"]["messages"] / len(MISSION.messages)
        assert math.isclose(read["readable_percent"], 100 * share)
    elif storage is StoragePlugin.MCAP:  # nothing tells how long the file was to be
        assert read["readable_percent"] is None
        assert "damaged: ends at 2023-11-14 22:13:23.960 UTC; how much is missing is not known" in ran.out
    if read["readable_percent"] is not None:
        assert 75 < read["readable_percent"] < 95
        percent = round(read["readable_percent"])
        assert f"damaged: {percent} % readable, ends at 2023-11-14 22:13:23.960 UTC" in ran.out
    assert sum(": cut off" in notice for notice in read["notices"]) == 1


def test_what_is_lost_of_a_cut_bag_is_said_beside_the_table(desk: Desk, tmp_path: Path) -> None:
    path = next((tmp_path / "sent").glob("*.db3"))
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 69 // 100])
    ran = desk.bag("info", "sent")
    assert ran.code == 0
    damage = "69 % readable, ends at 2023-11-14 22:13:22.607 UTC"
    assert "\ndamaged: 66 % readable, ends at 2023-11-14 22:13:22.607 UTC\n" in ran.out
    assert ran.err == f"note: {Path('sent', path.name)}: cut off: {damage} after 107 messages\n"
    assert desk.bag("info", "sent", "--json").json["notices"] == [ran.err.removeprefix("note: ").rstrip("\n")]


def test_a_cut_bag_of_which_no_message_is_left_says_why(desk: Desk, tmp_path: Path) -> None:
    path = next((tmp_path / "sent").glob("*.db3"))
    path.write_bytes(path.read_bytes()[: 8 * 4096])
    why = "cut off: no message could be read"
    assert (
        desk.refuses("info", "sent")
        == f"sent: error: none of its 161 messages can be read; {Path('sent', path.name)}: {why}"
    )


def test_bags_that_cannot_be_shown_are_refused_in_one_line(desk: Desk, tmp_path: Path) -> None:
    (tmp_path / "notes.db3").write_text("dear diary, today")
    (tmp_path / "notes.txt").write_text("dear diary, today")
    refusals = {
        "nowhere": f"nowhere: error: no such file or folder; {BAG_EXPECTED}",
        "notes.db3": f"notes.db3: error: not a recording: unknown file header; {BAG_EXPECTED}",
        "notes.txt": f"notes.txt: error: unknown storage '.txt'; {BAG_EXPECTED}",
    }
    for bag, refusal in refusals.items():
        for action in ("info", "rates", "bandwidth"):
            assert desk.refuses(action, bag) == refusal
        assert desk.refuses("compare", "sent", bag) == refusal


@pytest.mark.parametrize("text", ["/odom", "=/odom", "/odom="])
def test_half_a_pair_is_wrong_usage(desk: Desk, text: str) -> None:
    ran = desk.bag("compare", "a", "b", "--map", text)
    assert ran.code == 2
    assert f"two topics are paired as in /a=/b, not {text!r}" in ran.err


def test_a_topic_paired_twice_is_wrong_usage(desk: Desk) -> None:
    ran = desk.bag("compare", "a", "b", "--map", "/odom=/x", "--map", "/scan=/x")
    assert (ran.code, ran.err) == (2, "--map: error: a topic is paired twice; give each topic once\n")


def test_messages_of_one_instant_have_no_bandwidth(desk: Desk, tmp_path: Path) -> None:
    message = BagMessage(ODOM.name, START_NS, odometry(0.0, 0.0))
    write_bag(tmp_path / "instant", BagContent((ODOM,), (message, message)))
    ran = desk.bag("bandwidth", "instant", "--json").json
    assert ran["topics"]["/odom"]["kb_per_s"] is ran["total"]["kbit_per_s"] is None
    assert ran["topics"]["/odom"]["longest_gap_s"] == 0
