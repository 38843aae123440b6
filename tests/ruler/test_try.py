# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page learns about its rules from a bag."""

from __future__ import annotations

import gzip
import json
import socket
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from bags.bag_factory import small_mission, write_bag
from replays.replay_runs import replay_bag
from ruler.page_socket import open_socket
from ruler.ruler_server import TIMEOUT_S, Page, served
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.record import to_json
from smarttestudo.domain.signal import Truth
from smarttestudo.ruler.rules.document import Draft
from smarttestudo.ruler.tries.try_rules import TryAnswer, TryLimits, try_rules

STATEMENTS = """\
  SetFrequency /odom 10
  SetFrequency /scan 1
  Rule "Far" If (CheckValue /odom pose_y > 2) Then SetFrequency /scan 5
"""
RULES = f"begin\n{STATEMENTS}\nend\n"


LOSS_STATEMENTS = """\
  SetFrequency /odom 2
  SetFrequency /scan Off
  SetFrequency /image 1
  SetFrequency /gripper 3
  SetFrequency /map_name 1
  Rule "Far" If (CheckValue /odom pose_y > 2) Then SetFrequency /odom 5 SetFrequency /scan 2
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("project")
    write_bag(folder / "monday", small_mission())
    (folder / "broken").mkdir()
    (folder / "broken" / "metadata.yaml").write_text("no bag")
    return folder


@pytest.fixture(scope="module")
def page(project: Path) -> Iterator[Page]:
    with served(project) as page:
        yield page


def test_a_try_travels_compressed_where_the_page_takes_that(page: Page) -> None:
    asked = {"text": RULES, "bag": "monday"}
    plain = page.post("/api/try", asked)
    packed = page.request("POST", "/api/try", json.dumps(asked), {"Accept-Encoding": "gzip"})
    assert packed.headers["content-encoding"] == "gzip"
    assert len(packed.body) < len(plain.body) / 2
    assert json.loads(gzip.decompress(packed.body)) == plain.json


def shown(decision: Decision) -> dict[str, object]:
    """What the page is told of a decision."""
    record = {"start": False, "bounds": [], **decision.to_json()}
    return {key: value for key, value in record.items() if key not in {"stamp_ns", "values"}}


def test_a_try_counts_what_testudo_replay_would_write(page: Page, project: Path, tmp_path: Path) -> None:
    tried = page.post("/api/try", {"text": RULES, "bag": "monday"}).json
    run = replay_bag(project / "monday", STATEMENTS, tmp_path, profile=Profile())
    assert {one["topic"] for one in tried["topics"]} == set(run.outcome.topics)
    for one in tried["topics"]:
        expected = run.outcome.topics[one["topic"]]
        # Where it is written, it has another name.
        assert one["outcome"] == {**to_json(expected), "monitored_topic": one["outcome"]["monitored_topic"]}
        assert sum(one["before_hz_bins"]) * tried["bin_s"] == pytest.approx(expected.messages_in)
        assert sum(one["after_hz_bins"]) * tried["bin_s"] == expected.messages_out
    assert tried["decisions"] == [shown(decision) for decision in run.decisions]
    assert tried["decision_count"] == len(run.decisions)
    assert tried["percent"] == pytest.approx(100 * (1 - tried["after_kb"] / tried["before_kb"]))
    assert sorted(project.iterdir()) == [project / "broken", project / "monday"]


def test_of_a_topic_with_two_types_a_try_counts_the_first(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", small_mission())
    with closing(sqlite3.connect(bag / "bag.db3")) as database:
        columns = ", ".join(row[1] for row in database.execute("PRAGMA table_info(topics)") if row[1] != "id")
        others = columns.replace("type,", "'std_msgs/msg/String',")
        database.execute(f"INSERT INTO topics ({columns}) SELECT {others} FROM topics WHERE name = '/odom'")
        (second,) = database.execute("SELECT max(id) FROM topics").fetchone()
        database.execute(
            "INSERT INTO messages (topic_id, timestamp, data) "
            "SELECT ?, timestamp + 1, data FROM messages JOIN topics ON topic_id = topics.id "
            "WHERE name = '/odom' AND topic_id != ?",
            (second, second),
        )
        database.commit()
    tried = try_rules(Draft(text=RULES, name="rules.adirf"), bag, lambda _: None)
    assert "/odom: recorded with two types; left out of the second: 100 messages" in tried.notices
    odom = next(one for one in tried.topics if one.topic == "/odom")
    assert sum(odom.before_hz_bins) * tried.bin_s == odom.outcome.messages_in == 100


def test_a_try_loses_what_testudo_bag_loss_says(page: Page, project: Path, tmp_path: Path) -> None:
    (tmp_path / "rules.adirf").write_text(f"begin\n{LOSS_STATEMENTS}\nend\n")
    tried = page.post("/api/try", {"text": f"begin\n{LOSS_STATEMENTS}\nend\n", "bag": "monday"}).json["loss"]
    bag, monitored, rules = project / "monday", tmp_path / "monitored", tmp_path / "rules.adirf"
    command_line("replay", bag, "--rules", rules, "--output", monitored)
    said = command_line("bag", "loss", bag, monitored, "--rules", rules)
    expected = {one["topic"]: one for one in tried["topics"]}
    assert list(expected) == list(said["topics"])
    for topic, loss in said["topics"].items():
        assert {arm: expected[topic][arm] for arm in ("sent", "received")} == {
            arm: loss[arm] for arm in ("sent", "received")
        }
    assert [
        (one["topic"], one["field"], one["unit"], one["range"], one["hold"]) for one in tried["fields"]
    ] == [
        (
            *(one["topic"], one["field"], one["unit"], one["range"]),
            (one["received"] or {}).get("hold"),
        )
        for one in said["fields"]
    ]
    assert [one["hold"] for one in tried["fields"] if one["topic"] == "/odom"]
    assert tried["crossings"] == [
        {key: one[key] for key in ("check", "crossings", "received")} for one in said["crossings"]
    ]
    assert tried["images"] == [
        {arm: one[arm] for arm in ("topic", "sent", "received")} for one in said["images"]
    ]


def test_the_worst_moment_of_a_course_is_the_worst_of_all(page: Page) -> None:
    loss = page.post("/api/try", {"text": RULES, "bag": "monday"}).json["loss"]
    for one in loss["fields"]:
        if one["hold"]:
            worst = max(error for error in one["error_bins"] if error is not None)
            assert worst == pytest.approx(one["hold"]["max"], rel=1e-3)
    for one in loss["topics"]:
        if one["received"]["age"]:
            oldest = max(age for age in one["age_s_bins"] if age is not None)
            assert oldest == pytest.approx(one["received"]["age"]["max_s"], rel=1e-3)


def test_a_rule_holds_from_when_its_value_said_so(page: Page) -> None:
    tried = page.post("/api/try", {"text": RULES, "bag": "monday"}).json
    [block] = tried["blocks"]
    assert (block["rule"], block["line"]) == ("Far", 4)
    assert block["turns"][0] == [0, "unknown"]
    assert {truth for _, truth in block["turns"]} == {"unknown", "true", "false"}
    times = [t_s for t_s, _ in block["turns"]]
    assert times == sorted(times)
    assert tried["first_bin_s"] <= 0 < tried["first_bin_s"] + tried["bin_s"]
    raised = [one["t"] for one in tried["decisions"] if one["rule"] == "Far" and one["reason"] == "block"]
    assert set(raised) <= {t_s for t_s, truth in block["turns"] if truth == "true"}


def tried_within(limits: TryLimits, project: Path) -> TryAnswer:
    return try_rules(Draft(text=RULES, name="rules.adirf"), project / "monday", lambda _: None, limits)


def test_a_bag_with_more_messages_than_are_kept_says_for_how_long_its_loss_counts(project: Path) -> None:
    tried = tried_within(TryLimits(samples=20), project)
    assert sum(one.sent.messages for one in tried.loss.topics) == 20
    assert any(notice.endswith("s, in which 20 messages came") for notice in tried.notices)


def test_the_path_comes_from_the_odometry(page: Page) -> None:
    path = page.post("/api/try", {"text": RULES, "bag": "monday"}).json["path"]
    assert len(path) > 2
    assert [point[0] for point in path] == sorted(point[0] for point in path)


def test_progress_is_told_over_the_web_socket(page: Page) -> None:
    with open_socket(page) as listener:
        listener.next("hello")
        page.post("/api/try", {"text": RULES, "bag": "monday", "run": "try-7"})
        said = listener.next("progress")
    assert said["run"] == "try-7"
    assert 0 < said["share"] <= 1


@pytest.mark.parametrize(
    ("bag", "status"), [("nothing", 404), ("../project/monday", 403), ("broken", 422), ("/etc", 403)]
)
def test_a_bag_that_cannot_be_tried_is_refused_with_a_sentence(page: Page, bag: str, status: int) -> None:
    answer = page.post("/api/try", {"text": RULES, "bag": bag})
    assert answer.status == status
    assert answer.error


@pytest.mark.parametrize("path", ["/api/try", "/api/try/headline"])
def test_rules_with_errors_are_not_tried(page: Page, path: str) -> None:
    answer = page.post(path, {"text": "begin SetFrequency /odom Desirable end", "bag": "monday"})
    assert answer.status == 409
    [finding, *_] = answer.json["error"]["findings"]
    assert finding["code"] == "tier-without-rate"
    assert "topic parameters" in finding["hint"]
    assert "--" not in finding["hint"]


@pytest.mark.parametrize("path", ["/api/try", "/api/try/headline"])
def test_a_page_that_leaves_gives_its_turn_to_the_next(page: Page, path: str) -> None:
    body = json.dumps({"text": RULES, "bag": "monday"}).encode()
    head = (
        f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{page.port}\r\nContent-Type: application/json\r\n"
        f"Content-Length: {len(body)}\r\n\r\n"
    )
    for _ in range(3):
        with socket.create_connection(("127.0.0.1", page.port), timeout=TIMEOUT_S) as leaver:
            leaver.sendall(head.encode() + body)
    assert page.post(path, {"text": RULES, "bag": "monday"}).status == 200


def test_a_profile_measured_in_a_bag_fills_the_table(page: Page) -> None:
    text = page.post("/api/profile/measure", {"bag": "monday"}).json["text"]
    rows = page.post("/api/profile/parse", {"text": text}).json["rows"]
    assert {"/odom", "/scan"} <= {row["topic"] for row in rows}


def test_a_curve_is_that_of_testudo_bag_loss_and_its_levels_those_of_testudo_profile(
    page: Page, project: Path
) -> None:
    answer = page.post("/api/profile/curve", {"bag": "monday", "topic": "/odom"}).json
    said = command_line("bag", "loss", project / "monday", "--topics", "/odom")["topics"]["/odom"]
    assert answer["source_hz"] == said["source_hz"]
    assert answer["tiers_hz"] == said["tiers_hz"]
    assert [(one["rate_hz"], one["kb_per_s"]) for one in answer["points"]] == [
        (one["hz"], one["kb_per_s"]) for one in said["points"]
    ]
    for shown, point in zip(answer["points"], said["points"], strict=True):
        errors = [field["hold"]["relative_rmse"] or 0 for field in point["fields"].values()]
        assert shown["error_percent"] == pytest.approx(100 * max(errors))
        assert shown["worst_field"] in point["fields"]


def test_a_topic_without_numbers_has_no_curve_and_one_that_is_not_there_is_refused(page: Page) -> None:
    answer = page.post("/api/profile/curve", {"bag": "monday", "topic": "/map_name"})
    assert (answer.status, answer.json["points"]) == (200, [])
    answer = page.post("/api/profile/curve", {"bag": "monday", "topic": "/odm"})
    assert answer.status == 422
    assert "/odm" in answer.error
    assert page.post("/api/profile/curve", {"bag": "monday", "topic": "/*"}).status == 400
    assert page.post("/api/profile/curve", {"bag": "../monday", "topic": "/odom"}).status == 403


def test_levels_can_begin_with_shares_of_the_sources_rate(page: Page) -> None:
    assert page.post("/api/profile/levels", {"source_hz": 20}).json["tiers_hz"] == [1, 2, 5, 10, 16, 20]
    assert page.post("/api/profile/levels", {"source_hz": 0}).status == 422


def test_many_decisions_are_cut_and_counted(project: Path) -> None:
    tried = tried_within(TryLimits(decisions=1), project)
    assert len(tried.decisions) == 1
    assert tried.decision_count > 1
    assert any("only the first 1 decisions are shown" in notice for notice in tried.notices)


def test_of_a_recording_without_messages_nothing_is_saved(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "bag", small_mission().between(0, 0))
    tried = try_rules(Draft(name="rules.adirf", text=RULES), bag, lambda _: None)
    assert (tried.before_kb, tried.after_kb, tried.percent) == (0, 0, 0)


def test_decisions_say_which_bound_decides_and_whether_it_is_in_doubt(project: Path) -> None:
    text = """begin
        SetFrequency /odom Full
        Rule "Far" If CheckValue /odom pose_y > 2 Then KeepWithin /odom position 0.05
        Rule "Long" If CheckValue /odom pose_y > -9 For 60 min Then KeepWithin /odom position 0.01
        end"""
    tried = try_rules(Draft(name="rules.adirf", text=text), project / "monday", lambda _: None)
    bounds = [one.bounds for one in tried.decisions if one.topic == "/odom"]
    assert bounds[0] == ("position not bound, in doubt: Long",)
    assert bounds[-1] == ("position 0.01, in doubt: Long",)


def test_rules_that_turn_too_often_are_unknown_from_then_on(project: Path) -> None:
    tried = tried_within(TryLimits(turns=1), project)
    [block] = tried.blocks
    assert [truth for _, truth in block.turns] == [Truth.UNKNOWN, Truth.FALSE, Truth.UNKNOWN]
    after = f"their states after {block.turns[-1][0]:.1f} s are left out"
    assert f"rules changed their state more than 1 times; {after}" in tried.notices
    whole = tried_within(TryLimits(), project)
    assert [truth for _, truth in whole.blocks[0].turns] == [Truth.UNKNOWN, Truth.FALSE, Truth.TRUE]
    assert not any("are left out" in notice for notice in whole.notices)


def command_line(*arguments: object) -> Any:
    """What the command line says with ``--json``."""
    command = [sys.executable, "-m", "smarttestudo", *map(str, arguments), "--json"]
    return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)


def test_the_needs_of_accuracies_are_those_of_testudo_profile(page: Page) -> None:
    answer = page.post("/api/profile/accuracy", {"bag": "monday", "topic": "/odom"}).json
    text = page.post("/api/profile/measure", {"bag": "monday"}).json["text"]
    rows = page.post("/api/profile/parse", {"text": text}).json["rows"]
    odom = next(row for row in rows if row["topic"] == "/odom")
    (position,) = answer["properties"]
    assert (position["property"], position["unit"]) == ("position", "m")
    assert [one["bound"] for one in position["points"]] == odom["tiers_m"]
    assert [one["hold_hz"] for one in position["points"]] == pytest.approx(odom["tiers_m_need_hz"], rel=0.005)
    assert all(one["reckoned_hz"] <= one["hold_hz"] for one in position["points"])


def test_a_topic_without_a_position_needs_nothing_and_one_that_is_not_there_is_refused(page: Page) -> None:
    answer = page.post("/api/profile/accuracy", {"bag": "monday", "topic": "/scan"})
    assert (answer.status, answer.json["properties"]) == (200, [])
    answer = page.post("/api/profile/accuracy", {"bag": "monday", "topic": "/odm"})
    assert answer.status == 422
    assert "/odm" in answer.error
