# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from bags.bag_factory import ODOM, START_NS, BagContent, BagMessage, odometry, small_mission, write_bag
from bags.bag_reading import read_bag, read_with_rosbags
from replays.replay_runs import of_robot
from smarttestudo.bags.writer import create_recording
from smarttestudo.cli.main import main
from smarttestudo.domain.recording import Channel

MISSION = small_mission()
RULES = """\
begin
  SetFrequency /odom 10
  SetFrequency /scan 1
  Rule "Far" If (CheckValue /odom pose_y > 2) Then SetFrequency /scan 5
end
"""
BAG_EXPECTED = "give a rosbag2 folder, a .db3 or an .mcap file"


@dataclass(frozen=True)
class Ran:
    code: int
    out: str
    err: str


class Desk:
    """A folder with a bag and rules, in which ``testudo replay`` is run."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self.folder = folder
        self._capsys = capsys
        self.write_rules(RULES)
        write_bag(folder / "bag", MISSION)

    def write_rules(self, text: str, encoding: str = "utf-8") -> None:
        (self.folder / "rules.adirf").write_bytes(text.encode(encoding))

    def replay(self, *options: str, bag: str = "bag", output: str = "out") -> Ran:
        self._capsys.readouterr()
        code = main(["replay", bag, "--rules", "rules.adirf", "--output", output, *options])
        captured = self._capsys.readouterr()
        return Ran(code, captured.out, captured.err)

    def refuses(self, *options: str, bag: str = "bag", output: str = "out") -> str:
        """The one line that a refusal prints; nothing is left behind."""
        before = sorted(self.folder.rglob("*"))
        ran = self.replay(*options, bag=bag, output=output)
        assert (ran.code, ran.out) == (1, "")
        assert sorted(self.folder.rglob("*")) == before
        assert ran.err.count("\n") == 1
        return ran.err.rstrip("\n")


@pytest.fixture
def desk(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Desk:
    monkeypatch.chdir(tmp_path)
    return Desk(tmp_path, capsys)


def test_a_replay_prints_narrow_tables_and_nothing_on_stderr(desk: Desk) -> None:
    ran = desk.replay()
    assert (ran.code, ran.err) == (0, "")
    rows = [line.split() for line in ran.out.splitlines() if line.startswith(("/odom", "/scan", "All"))]
    rates, volumes = rows[:2], rows[2:]
    assert rates[0][:5] == ["/odom", "100", "41", "25.00", "10.00"]
    assert rates[1][:2] == ["/scan", "20"]
    assert [row[0] for row in volumes] == ["/odom", "/scan", "All"]
    assert max(map(len, ran.out.splitlines())) < 80
    assert "decisions in" in ran.out


def test_json_is_one_object_with_the_numbers_of_each_topic(desk: Desk) -> None:
    ran = desk.replay("--json")
    outcome = json.loads(ran.out)
    assert set(outcome) >= {"topics", "decisions", "wall_seconds"}
    assert set(outcome["topics"]) == {"/odom", "/scan"}
    odom = outcome["topics"]["/odom"]
    assert odom["in"] == 100
    assert odom["out"] == len([m for m in read_bag(desk.folder / "out").messages if m.topic == "/odom"])
    assert odom["repeated"] == 0
    assert odom["source_hz"] == pytest.approx(25.0)
    assert odom["target_hz"] == pytest.approx(10.0)
    assert odom["error_percent"] == pytest.approx(100 * (odom["mean_hz"] / 10 - 1))
    assert odom["in_kb"] == pytest.approx(100 * len(MISSION.messages[0].payload) / 1000)
    assert odom["out_kb"] == pytest.approx(odom["in_kb"] * odom["out"] / odom["in"])
    assert outcome["total"]["out"] == odom["out"] + outcome["topics"]["/scan"]["out"]


def test_decisions_are_lines_of_json_in_order_as_many_as_counted(desk: Desk) -> None:
    outcome = json.loads(desk.replay("--json", "--decisions", "log.jsonl").out)
    decisions = [json.loads(line) for line in (desk.folder / "log.jsonl").read_text().splitlines()]
    assert len(decisions) == outcome["decisions"]
    assert [decision["t"] for decision in decisions] == sorted(decision["t"] for decision in decisions)
    starts = [decision["topic"] for decision in decisions if decision.get("start")]
    assert starts == ["/odom", "/scan"]
    (far,) = (
        decision for decision in decisions if decision["rule"] == "Far" and decision["reason"] == "block"
    )
    assert far == {
        "t": 2.04,
        "stamp_ns": START_NS + 2_040_000_000,
        "topic": "/scan",
        "from_hz": 1.0,
        "to_hz": 5.0,
        "reason": "block",
        "rule": "Far",
        "line": 4,
        "values": {"/odom pose_y": 2.04},
    }


def test_the_report_is_one_page_that_names_topics_and_rules(desk: Desk) -> None:
    assert desk.replay("--report", "page.html", "--output-topic", "/operator{topic}").code == 0
    page = (desk.folder / "page.html").read_text()
    assert page.startswith("<!DOCTYPE html>")
    assert all(word in page for word in ("/odom", "/scan", "Far", "Replay of bag"))


def test_rules_come_from_several_files_and_folders(desk: Desk) -> None:
    more = desk.folder / "more"
    more.mkdir()
    (more / "image.adirf").write_text("begin SetFrequency /image 1 end")
    (desk.folder / "map.adirf").write_text("begin SetFrequency map_name Full end")
    outcome = json.loads(desk.replay("--rules", "more", "map.adirf", "--json").out)
    assert list(outcome["topics"]) == ["/odom", "/scan", "/image", "/map_name"]


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_storage_and_names_are_as_asked(desk: Desk, storage: str) -> None:
    assert desk.replay("--storage", storage, "--output-topic", "/testudo{topic}").code == 0
    suffix = {"sqlite3": "db3", "mcap": "mcap"}[storage]
    assert (desk.folder / "out" / f"out.{suffix}").is_file()
    topics = {m.topic for m in read_with_rosbags(desk.folder / "out")}
    assert topics == {"/testudo/odom", "/testudo/scan", "/testudo/decisions"}


def test_repeating_is_asked_for_by_name(desk: Desk) -> None:
    desk.write_rules("begin SetFrequency /scan 20 end")
    assert json.loads(desk.replay("--json", "--when-slow", "repeat").out)["topics"]["/scan"]["repeated"] > 0


def test_a_profile_is_used(desk: Desk) -> None:
    (desk.folder / "profile.toml").write_text('settle_s = 0.0\n[topics."/odom"]\nstale_after_s = 0.01\n')
    ran = desk.replay("--profile", "profile.toml", "--decisions", "log.jsonl")
    assert ran.code == 0
    lines = (desk.folder / "log.jsonl").read_text().splitlines()
    assert sum(json.loads(line)["reason"] == "unknown" for line in lines) > 10


def test_a_missing_bag(desk: Desk) -> None:
    assert desk.refuses(bag="nowhere") == f"nowhere: error: no such file or folder; {BAG_EXPECTED}"


def test_an_empty_bag_folder(desk: Desk) -> None:
    (desk.folder / "empty").mkdir()
    assert (
        desk.refuses(bag="empty") == f"empty: error: the folder holds no .db3 or .mcap file; {BAG_EXPECTED}"
    )


@pytest.mark.parametrize("name", ["empty.db3", "empty.mcap"])
def test_an_empty_bag_file(desk: Desk, name: str) -> None:
    (desk.folder / name).touch()
    assert desk.refuses(bag=name) == f"{name}: error: the file is empty; {BAG_EXPECTED}"


def test_a_file_that_is_no_bag(desk: Desk) -> None:
    line = desk.refuses(bag="rules.adirf")
    assert line == f"rules.adirf: error: unknown storage '.adirf'; {BAG_EXPECTED}"


def test_an_output_that_exists(desk: Desk) -> None:
    (desk.folder / "out").mkdir()
    assert desk.refuses() == "out: error: exists already; remove it or name another output"


def test_an_output_that_cannot_be_written(desk: Desk) -> None:
    assert desk.refuses(output="/proc/out").startswith("/proc/out: error: cannot be written: ")


def test_a_decision_log_that_cannot_be_written(desk: Desk) -> None:
    line = desk.refuses("--decisions", "nowhere/log.jsonl")
    cause = "the decision log cannot be written: No such file or directory"
    assert line == f"nowhere/log.jsonl: error: {cause}; name another place"


def test_a_report_that_cannot_be_written(desk: Desk) -> None:
    (desk.folder / "there").mkdir()
    line = desk.refuses("--report", "there")
    assert line == "there: error: the report cannot be written: it is a folder; name another place"


def test_rules_in_utf_16(desk: Desk) -> None:
    desk.write_rules(RULES, "utf-16")
    assert desk.refuses() == "rules.adirf: error: the rule file is in UTF-16; save it as UTF-8"


def test_rules_of_ten_megabytes(desk: Desk) -> None:
    desk.write_rules("// " + "x" * 10_000_000)
    line = desk.refuses()
    assert line.startswith("rules.adirf: error: the rule file is larger than 4 MB; ")


def test_missing_rules(desk: Desk) -> None:
    (desk.folder / "rules.adirf").unlink()
    assert desk.refuses() == "rules.adirf: error: there is no such file; check the path"


def test_empty_rules(desk: Desk) -> None:
    desk.write_rules("")
    ran = desk.replay()
    assert (ran.code, ran.out) == (1, "")
    assert ran.err.startswith("rules.adirf:1:1: error[")


def test_all_errors_of_the_rules_are_printed_with_their_places(desk: Desk) -> None:
    desk.write_rules(
        "begin\n  SetFreqency /odom 10\n  SetFrequency /scan Desirable\n  SetFrequency /scan x\nend\n"
    )
    ran = desk.replay()
    assert (ran.code, ran.out) == (1, "")
    places = [line for line in ran.err.splitlines() if line.startswith("rules.adirf:")]
    assert [place.split(":")[1] for place in places] == ["2", "3", "4"]
    assert all(": error[" in place for place in places)
    assert not (desk.folder / "out").exists()


def test_a_type_that_the_bag_does_not_define_where_a_check_reads_it(desk: Desk) -> None:
    with create_recording(desk.folder / "odd") as writer:
        writer.write(Channel(topic="/odd", type_name="nobody_msgs/msg/Odd"), START_NS, b"\x00\x01\x00\x00")
    desk.write_rules("begin SetFrequency /odd 1 If (CheckValue /odd value > 1) Then SetFrequency /odd 2 end")
    assert desk.refuses(bag="odd") == (
        "/odd: error: a check reads it, and it cannot be decoded: "
        "neither the recording nor ROS 2 defines nobody_msgs/msg/Odd; leave out the check"
    )
    desk.write_rules("begin SetFrequency /odd 1 end")
    assert desk.replay(bag="odd").code == 0
    assert [m.payload for m in of_robot(read_bag(desk.folder / "out").messages)] == [b"\x00\x01\x00\x00"]


def test_names_that_clash_are_a_usage_error(desk: Desk) -> None:
    ran = desk.replay("--output-topic", "/all")
    assert ran.code == 2
    assert ran.err == (
        "--output-topic: error: '/all' gives all topics the same name; "
        "write it with {topic}, as in /testudo{topic}\n"
    )
    assert not (desk.folder / "out").exists()


def test_what_was_lost_is_named_at_the_end_and_the_replay_succeeds(desk: Desk) -> None:
    messages = list(MISSION.messages)
    odometries = [place for place, message in enumerate(messages) if message.topic == ODOM.name]
    messages[odometries[3]] = BagMessage("/odom", messages[odometries[3]].stamp_ns, b"\x00\x01\x00\x00?")
    messages[odometries[5]] = BagMessage("/odom", messages[odometries[5]].stamp_ns, odometry(0, float("nan")))
    storage = write_bag(desk.folder / "hurt", BagContent(MISSION.topics, tuple(messages))) / "hurt.db3"
    storage.write_bytes(storage.read_bytes()[: storage.stat().st_size * 9 // 10])
    desk.write_rules(RULES.replace("  SetFrequency /scan 1", "  SetFrequency /scan 1\n  SetFrequency /imu 1"))
    ran = desk.replay(bag="hurt")
    assert ran.code == 0
    notes = ran.err.splitlines()
    assert notes[0] == "note: /imu: not in the recording, so nothing of it is relayed"
    assert notes[1].startswith("note: hurt/hurt.db3: cut off: 90 % readable, ends at ")
    assert notes[1].endswith(" messages")
    assert notes[2:] == [
        "note: /odom: 1 message could not be decoded; what checks read was unknown",
        "note: /odom pose_y: unknown in 1 message (NaN, said to be unknown, or no such field)",
    ]


def test_progress_is_shown_on_a_terminal_only(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setitem(sys.modules, "rich.progress", None)
    ran = desk.replay()
    assert ran.code == 0
    assert "Replaying bag 0 %" in ran.err
    assert "Replaying bag 100 %" in ran.err
    assert ran.err.endswith("\r\x1b[K")
    assert "Replaying" not in ran.out


def test_an_infinite_value_that_a_check_read_is_null(desk: Desk) -> None:
    messages = [BagMessage("/odom", START_NS + i * 100_000_000, odometry(0.0, math.inf)) for i in range(20)]
    write_bag(desk.folder / "endless", BagContent((ODOM,), tuple(messages)))
    desk.write_rules(RULES.replace("/scan", "/odom").replace("/odom 5", "/odom 7"))
    ran = desk.replay("--decisions", "decisions.jsonl", "--json", bag="endless")
    assert (ran.code, json.loads(ran.out)["topics"]["/odom"]["in"]) == (0, 20)
    last = json.loads((desk.folder / "decisions.jsonl").read_text().splitlines()[-1])
    assert (last["rule"], last["values"]) == ("Far", {"/odom pose_y": None})


def test_a_rule_for_a_topic_that_the_recording_lacks_costs_the_report_nothing(desk: Desk) -> None:
    desk.write_rules(RULES.replace("begin\n", "begin\n  SetFrequency /camera/image_raw 3\n"))
    ran = desk.replay("--report", "page.html", "--decisions", "decisions.jsonl")
    assert ran.code == 0
    assert "/camera/image_raw: not in the recording" in ran.err
    assert "/scan" in (desk.folder / "page.html").read_text(encoding="utf-8")


def test_a_replay_that_relays_nothing_has_a_report_of_the_recording(desk: Desk) -> None:
    desk.write_rules("begin SetFrequency /nothing 3 end")
    ran = desk.replay("--report", "page.html", "--decisions", "decisions.jsonl")
    assert (ran.code, ran.err.count("\n")) == (0, 1), ran.err
    assert (desk.folder / "decisions.jsonl").read_text().count("\n") == 1
    assert (desk.folder / "out").is_dir()
    assert "/odom" in (desk.folder / "page.html").read_text()


SECOND = 1_000_000_000
LAST_NS = 2**63 - 1


@pytest.mark.parametrize("options", [("--budget", "2"), ("--when-slow", "repeat")])
@pytest.mark.parametrize("start_ns", [START_NS, LAST_NS - 5 * SECOND])
def test_a_clock_that_was_set_in_the_middle_costs_no_time(
    desk: Desk, start_ns: int, options: tuple[str, ...]
) -> None:
    stamps_ns = [origin_ns + i * SECOND // 10 for origin_ns in (0, start_ns) for i in range(50)]
    messages = [BagMessage("/odom", at_ns, odometry(0.0, i / 10)) for i, at_ns in enumerate(stamps_ns)]
    write_bag(desk.folder / "set", BagContent((ODOM,), tuple(messages)))
    desk.write_rules("begin SetFrequency /odom 20 end")
    ran = desk.replay(*options, "--json", bag="set")
    assert ran.code == 0
    assert json.loads(ran.out)["topics"]["/odom"]["out"] < 250


def test_times_before_1970_are_no_times_for_mcap_and_sqlite_has_them(desk: Desk) -> None:
    messages = [BagMessage("/odom", i * SECOND, odometry(0.0, 0.0)) for i in range(-5, 5)]
    write_bag(desk.folder / "old", BagContent((ODOM,), tuple(messages)))
    desk.write_rules("begin SetFrequency /odom Full end")
    ran = desk.replay("--storage", "mcap", bag="old")
    assert (ran.code, ran.err.count("\n")) == (1, 1)
    assert "--storage sqlite3" in ran.err
    assert desk.replay(bag="old").code == 0
    written = of_robot(read_bag(desk.folder / "out").messages)
    assert [one.stamp_ns for one in written] == [m.stamp_ns for m in messages]


def test_the_error_is_against_the_mean_of_a_source_that_varies_and_says_so(desk: Desk) -> None:
    stamps_s = [number / 20 for number in range(40)] + [2 + number for number in range(11)]
    stamps_ns = [START_NS + round(1e9 * stamp_s) for stamp_s in stamps_s]
    messages = tuple(BagMessage("/odom", stamp_ns, odometry(0, 0)) for stamp_ns in stamps_ns)
    write_bag(desk.folder / "varies", BagContent((ODOM,), messages))
    desk.write_rules("begin SetFrequency /odom 10 end")
    ran = desk.replay(bag="varies")
    row = next(line.split() for line in ran.out.splitlines() if line.startswith("/odom"))
    source_hz, mean_hz, error_percent = (float(row[at].replace("−", "-")) for at in (3, 5, 6))
    assert error_percent == pytest.approx(100 * (mean_hz / source_hz - 1), abs=0.2)
    told = " ".join(ran.out.split())
    assert "against the target, or the source's mean where that is less" in told
    assert "Where the source's own rate varies, error says little." in told
