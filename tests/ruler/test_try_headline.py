# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The headline of a try, which stands for a recording among others."""

from __future__ import annotations

import asyncio
import json
import math
import os
import signal
import socket
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags.bag_factory import small_mission, write_bag
from ruler.ruler_server import TIMEOUT_S, Page, served
from smarttestudo.accuracy.loss_report import Age, ErrorSize, Frames, TopicArm
from smarttestudo.ruler import child
from smarttestudo.ruler.job import answer_json
from smarttestudo.ruler.rules.document import Draft
from smarttestudo.ruler.server.processes import Processes
from smarttestudo.ruler.tries.loss import (
    TriedRecording,
    TryFieldLoss,
    TryImages,
    TryLoss,
    TryTopicLoss,
    worst_field,
    worst_topic,
)
from smarttestudo.ruler.tries.try_rules import TryRequest, headline, try_rules

RULES = """\
begin
  SetFrequency /odom 2
  SetFrequency /scan Off
  SetFrequency /image 1
  Rule "Far" If (CheckValue /odom pose_y > 2) Then SetFrequency /odom 5 SetFrequency /scan 2
end
"""
SHOWN_TWICE = {
    *("duration_s", "before_kb", "after_kb", "percent", "worst_topic", "worst_field"),
    *("crossings", "missed_crossings", "notices"),
}


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("project")
    write_bag(folder / "runs" / "short", small_mission(3))
    write_bag(folder / "runs" / "long", small_mission(9))
    write_bag(folder / "runs" / "cut", small_mission(6))
    database = next((folder / "runs" / "cut").glob("*.db3"))
    database.write_bytes(database.read_bytes()[: database.stat().st_size * 2 // 3])
    (folder / "runs" / "broken").mkdir()
    (folder / "runs" / "broken" / "metadata.yaml").write_text("no bag")
    (folder / "runs" / "empty.mcap").write_bytes(b"")
    return folder


@pytest.fixture(scope="module")
def page(project: Path) -> Iterator[Page]:
    with served(project) as page:
        yield page


@pytest.mark.parametrize("bag", ["runs/short", "runs/long", "runs/cut"])
def test_a_headline_is_that_of_the_try(page: Page, bag: str) -> None:
    answer = page.post("/api/try/headline", {"text": RULES, "bag": bag})
    tried = page.post("/api/try", {"text": RULES, "bag": bag}).json
    assert answer.json == {
        "headline": {key: value for key, value in tried.items() if key in SHOWN_TWICE},
        "problem": "",
        "remedy": "",
    }
    assert answer.json["headline"].keys() == SHOWN_TWICE
    assert [one.partition(": ")[0] for one in tried["notices"]] == ["runs/cut/cut.db3"] * (bag == "runs/cut")
    assert tried["worst_topic"]["received"] < tried["worst_topic"]["sent"]
    assert tried["crossings"] == sum(one["crossings"] for one in tried["loss"]["crossings"])
    field, hold = tried["worst_field"], [one["hold"] for one in tried["loss"]["fields"] if one["hold"]]
    assert field["share"] == max(one["relative_rmse"] for one in hold if one["relative_rmse"] is not None)
    assert field["rmse"] in [one["rmse"] for one in hold]


@pytest.mark.parametrize("bag", ["runs/broken", "runs/empty.mcap", "runs/gone"])
def test_a_recording_that_cannot_be_tried_says_why_and_costs_no_other(
    page: Page, project: Path, bag: str
) -> None:
    answer = page.post("/api/try/headline", {"text": RULES, "bag": bag})
    assert answer.status == 200
    assert answer.json["headline"] is None
    assert answer.json["problem"]
    assert str(project).encode() not in answer.body
    assert page.post("/api/try/headline", {"text": RULES, "bag": "runs/short"}).json["headline"]


@pytest.mark.parametrize("bag", ["../project/runs/short", "/etc", "runs/../../x", ""])
def test_nothing_outside_the_project_is_tried(page: Page, bag: str) -> None:
    assert page.post("/api/try/headline", {"text": RULES, "bag": bag}).status == 403


CHILD = "\0".join([*child.command(headline, Path())[:-1], ""])


def processes() -> set[int]:
    """The processes for headlines that servers of this process have."""
    return {int(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdecimal() and is_ours(entry)}


def is_ours(entry: Path) -> bool:
    try:
        parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
        return parent == os.getpid() and CHILD in (entry / "cmdline").read_text()
    except OSError:
        return False


def has_ended(process: int) -> bool:
    """Whether it has, though the server, which is in this process, may not know yet."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


def eventually(holds: Callable[[], bool]) -> None:
    end_s = time.monotonic() + TIMEOUT_S
    while not holds():
        assert time.monotonic() < end_s
        time.sleep(0.01)


def test_the_next_recording_is_tried_in_a_process_that_was_there_before_it_was_asked_for(
    project: Path,
) -> None:
    asked = {"text": RULES, "bag": "runs/short"}
    others = processes()
    with served(project) as page, ThreadPoolExecutor() as pool:
        assert page.post("/api/try/headline", asked).json["headline"]
        (ready,) = processes() - others
        # As long as it stands still there is no answer.
        os.kill(ready, signal.SIGSTOP)
        answer = pool.submit(page.post, "/api/try/headline", asked)
        eventually(lambda: len(processes() - others) == 2)
        os.kill(ready, signal.SIGCONT)
        assert answer.result(TIMEOUT_S).json["headline"]
        eventually(lambda: len(processes() - others) == 1)
        assert ready not in processes()
        # A process that was lost is no reason to fail.
        (ready,) = processes() - others
        os.kill(ready, signal.SIGKILL)
        eventually(lambda: has_ended(ready))
        assert page.post("/api/try/headline", asked).json["headline"]
        assert len(processes() - others) == 1
    assert processes() <= others


def test_a_page_that_leaves_ends_the_process_at_work_only(project: Path) -> None:
    others = processes()
    with served(project) as page:
        page.post("/api/try/headline", {"text": RULES, "bag": "runs/short"})
        (ready,) = processes() - others
        os.kill(ready, signal.SIGSTOP)
        with socket.create_connection(("127.0.0.1", page.port), timeout=TIMEOUT_S) as leaver:
            body = json.dumps({"text": RULES, "bag": "runs/long"}).encode()
            head = (
                f"POST /api/try/headline HTTP/1.1\r\nHost: 127.0.0.1:{page.port}\r\n"
                f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
            )
            leaver.sendall(head.encode() + body)
            eventually(lambda: len(processes() - others) == 2)
        eventually(lambda: ready not in processes())
        assert len(processes() - others) == 1


def test_a_process_that_is_ready_ends_where_nothing_more_is_tried(project: Path) -> None:
    async def tried() -> None:
        work = Processes(project, idle_s=0)
        asked = TryRequest(text=RULES, bag="runs/short")
        assert await work.result(headline, asked, lambda _: None)
        while processes() - others:
            await asyncio.sleep(0.01)
        assert await work.result(headline, asked, lambda _: None)
        await work.close()

    others = processes()
    # Playwright, if a test before this one used it, keeps a running event loop in this thread.
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, asyncio.wait_for(tried(), TIMEOUT_S)).result()
    assert processes() <= others


def test_a_headline_stays_small_whatever_the_recording_has_to_say(project: Path) -> None:
    tried = try_rules(Draft(text=RULES), project / "runs" / "short", lambda _: None)
    notices = tuple(f"notice {number}" for number in range(50))
    headline = replace(tried, notices=notices).headline()
    assert headline.notices == (*notices[:3], "47 more notices")
    assert len(answer_json(TriedRecording(headline=headline))) < 1000


seconds = st.integers(0, 20).map(float)
counts = st.integers(0, 9)
names = st.lists(st.sampled_from(["/a", "/b", "/c", "/d"]), unique=True)


@cache
@st.composite
def losses(draw: st.DrawFn) -> TryLoss:
    """Topics of which at most as many messages arrive as were sent, at least one."""

    def arm(messages: int) -> TopicArm:
        known = Age(mean_s=0.0, p95_s=0.0, max_s=draw(seconds)) if messages else None
        return TopicArm(messages=messages, size_bytes=0, age=known)

    def topic(name: str) -> TryTopicLoss:
        received = draw(counts)
        sent = arm(received + draw(counts) or 1)
        return TryTopicLoss(topic=name, sent=sent, received=arm(received), age_s_bins=())

    def image(name: str) -> TryImages:
        received = draw(counts)
        sent = Frames(frames=received + draw(counts) or 1, longest_blind_s=draw(seconds))
        return TryImages(
            topic=name, sent=sent, received=Frames(frames=received, longest_blind_s=draw(seconds))
        )

    def field(name: str) -> TryFieldLoss:
        share = draw(st.none() | seconds)
        hold = ErrorSize(rmse=0.0, maximum=1.0, relative_rmse=share, relative_maximum=1.0)
        return TryFieldLoss(
            topic=name,
            field="x",
            unit="",
            sent=None,
            range=1.0,
            error_bins=(),
            hold=draw(st.sampled_from([None, hold])),
        )

    return TryLoss(
        topics=tuple(map(topic, draw(names))),
        fields=tuple(map(field, draw(names))),
        crossings=(),
        images=tuple(map(image, draw(names))),
    )


@given(losses())
def test_no_topic_and_no_property_lost_more_than_the_worst(loss: TryLoss) -> None:
    more_s = {
        one.topic: (one.received.age.max_s if one.received.age else math.inf)
        - (one.sent.age.max_s if one.sent.age else 0)
        for one in loss.topics
        if one.received.messages < one.sent.messages
    }
    for one in loss.images:
        more_s.pop(one.topic, None)
        if one.received.frames < one.sent.frames:
            lost_s = one.received.longest_blind_s - one.sent.longest_blind_s
            more_s[one.topic] = lost_s if one.received.frames else math.inf
    worst = worst_topic(loss)
    assert (worst is None) == (not more_s)
    if worst is not None:
        assert worst.more_s == more_s[worst.topic] == max(more_s.values())
        assert worst.is_image == (worst.topic in {one.topic for one in loss.images})
    shares = [(one.hold.relative_rmse or 0, one.topic) for one in loss.fields if one.hold]
    field = worst_field(loss)
    assert (field.share if field else 0) == max((share for share, _ in shares), default=0)
    assert field is None or (field.share, field.topic) in shares
