# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page learns about its rules from a bag."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from bags.bag_factory import small_mission, write_bag
from replay.replay_runs import replay_bag
from ruler.page_socket import open_socket
from ruler.ruler_server import TIMEOUT_S, Page, served
from smarttestudo.composition.ruler.checked_text import Draft
from smarttestudo.composition.ruler.trial import try_rules
from smarttestudo.domain.profile import Profile

STATEMENTS = """\
  SetFrequency /odom 10
  SetFrequency /scan 1
  Rule "Far" If (CheckValue /odom pose_y > 2) Then SetFrequency /scan 5
"""
RULES = f"begin\n{STATEMENTS}\nend\n"


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


def test_a_try_counts_what_testudo_replay_would_write(page: Page, project: Path, tmp_path: Path) -> None:
    tried = page.post("/api/try", {"text": RULES, "bag": "monday"}).json
    run = replay_bag(project / "monday", STATEMENTS, tmp_path, profile=Profile())
    assert {one["topic"] for one in tried["topics"]} == set(run.outcome.topics)
    for one in tried["topics"]:
        expected = run.outcome.topics[one["topic"]]
        assert one["before_messages"] == expected.messages_in
        assert one["after_messages"] == expected.messages_out
        assert one["before_kb"] == pytest.approx(expected.in_kb)
        assert one["after_kb"] == pytest.approx(expected.out_kb)
        assert sum(one["after_hz_bins"]) * tried["bin_s"] == expected.messages_out
    assert tried["decisions"] == [decision.to_json() for decision in run.decisions]
    assert tried["decision_count"] == len(run.decisions)
    assert tried["percent"] == pytest.approx(100 * (1 - tried["after_kb"] / tried["before_kb"]))
    assert sorted(project.iterdir()) == [project / "broken", project / "monday"]


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


def test_rules_with_errors_are_not_tried(page: Page) -> None:
    answer = page.post("/api/try", {"text": "begin SetFrequency /odom Desirable end", "bag": "monday"})
    assert answer.status == 409
    assert answer.json["error"]["findings"][0]["code"] == "tier-without-rate"


def test_a_page_that_leaves_gives_its_turn_to_the_next(page: Page) -> None:
    body = json.dumps({"text": RULES, "bag": "monday"}).encode()
    head = (
        f"POST /api/try HTTP/1.1\r\nHost: 127.0.0.1:{page.port}\r\nContent-Type: application/json\r\n"
        f"Content-Length: {len(body)}\r\n\r\n"
    )
    for _ in range(3):
        with socket.create_connection(("127.0.0.1", page.port), timeout=TIMEOUT_S) as leaver:
            leaver.sendall(head.encode() + body)
    assert page.post("/api/try", {"text": RULES, "bag": "monday"}).status == 200


def test_a_profile_measured_in_a_bag_fills_the_table(page: Page) -> None:
    text = page.post("/api/profile/measure", {"bag": "monday"}).json["text"]
    rows = page.post("/api/profile/parse", {"text": text}).json["rows"]
    assert {"/odom", "/scan"} <= {row["topic"] for row in rows}
    assert page.post("/api/vocabulary", {"bag": "monday"}).json["topics"][0]["source"] == "bag"


def test_many_decisions_are_cut_and_counted(project: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("smarttestudo.composition.ruler.trial.MAX_DECISIONS", 1)
    tried = try_rules(Draft(text=RULES, name="rules.adirf"), project / "monday", lambda _: None)
    assert len(tried.decisions) == 1
    assert tried.decision_count > 1
