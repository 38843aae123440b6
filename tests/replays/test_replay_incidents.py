# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo replay --incidents``: the windows that rules would have recorded, cut from a recording."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from bags.bag_factory import MAP_NAME, START_NS, BagContent, BagMessage, small_mission, write_bag
from bags.bag_reading import read_bag, read_with_mcap, read_with_rosbags
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.recording import Channel
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.loop.step import Trigger
from smarttestudo.replays.incidents import IncidentRequest, incident_cutter

MISSION = small_mission(10.0)
RULES = """\
begin
  SetFrequency /scan 1
  SetFrequency /map_name Full
  SetFrequency /odom 5
  Rule "Far" If CheckValue /odom pose_y > 5 Then
    Record "near miss" /odom /gripper Before 3 s After 2 s
    Record "{name}" Before 500 ms After 60 s
  EndIf
end
"""
TRIGGER_NS = START_NS + 126 * 40_000_000


def cut(
    folder: Path, *options: str, name: str = "all", output: str = "out", incidents: str = "incidents"
) -> int:
    if not (folder / "bag").exists():
        write_bag(folder / "bag", MISSION)
    rules = folder / "rules.adirf"
    rules.write_text(RULES.replace("{name}", name))
    arguments = ["replay", str(folder / "bag"), "--rules", str(rules), "--output", str(folder / output)]
    return main([*arguments, "--incidents", str(folder / incidents), *options])


def record_of(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "incident.json").read_text())
    return found


def folders(folder: Path) -> list[Path]:
    return sorted((folder / "incidents").iterdir())


def wanted(*topics: str, from_ns: int, to_ns: int) -> list[BagMessage]:
    return [one for one in MISSION.messages if one.topic in topics and from_ns <= one.stamp_ns <= to_ns]


def test_an_incident_holds_every_source_message_of_its_window(tmp_path: Path) -> None:
    assert cut(tmp_path) == 0
    path = next(one for one in folders(tmp_path) if one.name.endswith("near_miss"))
    assert path.name == "20231114T221325040Z-near_miss"
    start_ns, end_ns = TRIGGER_NS - 3_000_000_000, TRIGGER_NS + 2_000_000_000
    latched = BagMessage(MAP_NAME.name, start_ns, MISSION.messages[1].payload)
    assert latched.topic == MISSION.messages[1].topic
    expected = [latched, *wanted("/odom", "/gripper", from_ns=start_ns, to_ns=end_ns)]
    assert read_bag(path).messages == expected
    assert read_with_rosbags(path) == expected
    with_mcap = [one for file in path.glob("*.mcap") for one in read_with_mcap(file)]
    assert set(with_mcap) == set(expected)
    assert len(with_mcap) == len(expected)


def test_its_record_says_which_rule_when_and_what_is_missing(tmp_path: Path) -> None:
    assert cut(tmp_path) == 0
    near, everything = (
        record_of(next(one for one in folders(tmp_path) if one.name.endswith(name)))
        for name in ("near_miss", "all")
    )
    assert near["version"] == 1
    assert (near["name"], near["rule"], near["line"]) == ("near miss", "Far", 6)
    assert near["triggered_ns"] == TRIGGER_NS
    assert near["values"] == {"/odom pose_y": 5.04}
    assert near["missing"] == []
    assert near["latched"] == [{"topic": "/map_name", "stamp_ns": START_NS + 1}]
    assert set(near["topics"]) == {"/odom", "/gripper", "/map_name"}
    assert set(everything["topics"]) == {"/odom", "/gripper", "/map_name", "/scan"}
    assert {one["reason"] for one in everything["missing"]} == {"ended"}


def test_what_is_dead_from_the_start_is_recorded(tmp_path: Path) -> None:
    write_bag(tmp_path / "bag", MISSION)
    rule = 'If CheckValue /lidar rate < 1 Then Record "dead" /odom Before 2 s After 1 s EndIf'
    (tmp_path / "rules.adirf").write_text(f"begin\n  {rule}\nend\n")
    arguments = [str(tmp_path / "bag"), "--rules", str(tmp_path / "rules.adirf")]
    outputs = ["--output", str(tmp_path / "out"), "--incidents", str(tmp_path / "incidents")]
    assert main(["replay", *arguments, *outputs]) == 0
    (path,) = folders(tmp_path)
    record = record_of(path)
    assert (record["triggered_ns"], record["values"]) == (START_NS, {"/lidar rate": 0})
    assert read_bag(path).messages == wanted("/odom", from_ns=START_NS, to_ns=START_NS + 1_000_000_000)
    assert [(one["topic"], one["reason"]) for one in record["missing"]] == [("/odom", "late")]


def test_what_memory_cannot_hold_is_in_the_record(tmp_path: Path) -> None:
    large = [
        BagMessage("/image", START_NS + second * 1_000_000_000 + 5, bytes(600_000)) for second in range(1, 5)
    ]
    messages = sorted((*MISSION.messages, *large), key=lambda one: one.stamp_ns)
    write_bag(tmp_path / "bag", BagContent(MISSION.topics, tuple(messages)))
    rules = tmp_path / "rules.adirf"
    rules.write_text(RULES.replace("{name}", "all").replace("/odom /gripper", "/odom /image"))
    base = ["replay", str(tmp_path / "bag"), "--rules", str(rules), "--output", str(tmp_path / "out")]
    assert main([*base, "--incidents", str(tmp_path / "incidents"), "--incident-memory", "1"]) == 0
    path = next(one for one in folders(tmp_path) if one.name.endswith("near_miss"))
    (missing,) = record_of(path)["missing"]
    held = [one for one in read_bag(path).messages if one.topic == "/image"]
    window = [
        one
        for one in messages
        if one.topic == "/image" and abs(one.stamp_ns - TRIGGER_NS + 500_000_000) <= 2_500_000_000
    ]
    assert (missing["topic"], missing["reason"]) == ("/image", "memory")
    assert missing["messages"] == len(window) - len(held) > 0


@pytest.mark.parametrize("memory", ["0", "-1", "many", "nan"])
def test_memory_is_a_number_of_megabytes(tmp_path: Path, memory: str) -> None:
    assert cut(tmp_path, "--incident-memory", memory) == 2


def test_the_same_inputs_give_the_same_bytes(tmp_path: Path) -> None:
    assert cut(tmp_path) == 0
    assert cut(tmp_path, output="again", incidents="incidents again") == 0
    first, second = (
        {str(one.relative_to(root)): one.read_bytes() for one in root.rglob("*") if one.is_file()}
        for root in (tmp_path / "incidents", tmp_path / "incidents again")
    )
    assert len([name for name in first if name.endswith("incident.json")]) == 2
    assert first == second


@pytest.mark.parametrize("name", ["../../up", "a/b", "x" * 10_000, "Größe ✗", "…"])
def test_no_name_leads_out_of_the_folder(tmp_path: Path, name: str) -> None:
    assert cut(tmp_path, name=name) == 0
    assert {one.name for one in tmp_path.iterdir()} == {"bag", "rules.adirf", "out", "incidents"}
    assert len(folders(tmp_path)) == 2
    assert all(len(one.name) <= 80 for one in folders(tmp_path))
    assert name in {record_of(one)["name"] for one in folders(tmp_path)}


def test_an_existing_folder_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "incidents").mkdir()
    assert cut(tmp_path) == 1
    assert "incidents: error: exists already" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_answer_names_the_incidents(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cut(tmp_path, "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert sorted(answer["incidents"]) == [one.name for one in folders(tmp_path)]


def fail_within_a_window(folder: Path) -> None:
    rule_set = compile_rules([parse(RULES.replace("{name}", "all"), "rules.adirf").file], resolve_topic)
    sources = {"/odom": Channel(topic="/odom", type_name="nav_msgs/msg/Odometry")}
    request = IncidentRequest(into=folder, rules_sha256="")
    with incident_cutter(request, rule_set, sources, START_NS) as cutter:
        assert cutter is not None
        cutter.begin([Trigger(stamp_ns=START_NS, block=rule_set.blocks[0], values={})])
        cutter.on_message(sources["/odom"], START_NS + 1, b"odometry")
        raise RecordingError("the recording ends here")


def test_a_replay_that_fails_leaves_no_part_of_an_incident(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="ends here"):
        fail_within_a_window(tmp_path / "incidents")
    assert list((tmp_path / "incidents").iterdir()) == []


def test_incidents_are_not_written_over_an_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_bag(tmp_path / "bag", MISSION)
    assert cut(tmp_path, incidents="bag/incidents") == 2
    assert "--incidents: error:" in capsys.readouterr().err
