# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a check reads over a recording, and when it holds: the same that the rules decide by."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest

from bags.bag_factory import small_mission, write_bag
from ruler.page_projects import PROJECTS
from ruler.ruler_server import Page, served
from smarttestudo.domain.signal import Truth
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.rules.document import Draft
from smarttestudo.ruler.tries.check_course import (
    CheckCourse,
    CheckCourseRequest,
    check_course,
)
from smarttestudo.ruler.tries.try_rules import try_rules

FAR: dict[str, Any] = {"kind": "check", "topic": "/odom", "property": "pose_y", "op": ">", "value": 2}


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """8 m along y in 8 s."""
    folder = tmp_path_factory.mktemp("project")
    write_bag(folder / "monday", small_mission(8))
    return folder


@pytest.fixture(scope="module")
def page(project: Path) -> Iterator[Page]:
    with served(project) as page:
        yield page


def course_of(project: Path, condition: object) -> CheckCourse:
    request = msgspec.convert({"bag": "monday", "condition": condition}, CheckCourseRequest)
    return check_course(request, ProjectFolder(project), lambda _: None)


def timed(term: object, word: str, value: float, unit: str) -> dict[str, object]:
    return {"kind": "timed", "term": term, "word": word, "duration": {"value": value, "unit": unit}}


def test_the_values_are_those_of_the_recording_and_few(page: Page) -> None:
    course = page.post("/api/check/course", {"bag": "monday", "condition": FAR}).json
    known = [
        (least, greatest)
        for least, greatest in zip(course["least"], course["greatest"], strict=True)
        if least is not None
    ]
    assert len(course["least"]) + len(course["greatest"]) <= 2000
    assert all(least <= greatest for least, greatest in known)
    assert len(known) == len(course["least"]), "a value holds until the next one"
    assert known == sorted(known)
    assert known[0][0] == pytest.approx(0, abs=0.1)
    assert known[-1][1] == pytest.approx(8, abs=0.1)
    assert course["bin_s"] * len(course["least"]) == pytest.approx(course["duration_s"], abs=0.01)
    assert course["check"]["turns"] == course["condition"]["turns"]


@pytest.mark.parametrize(
    ("words", "condition"),
    [
        ("CheckValue /odom pose_y > 2", FAR),
        ("CheckValue /odom pose_y > 2 Until < 1", {**FAR, "until": {"op": "<", "value": 1}}),
        ("CheckValue /odom pose_y > 2 For 1.5 s", timed(FAR, "For", 1.5, "s")),
        ("CheckValue /odom pose_y < 2 Within 1500 ms", timed({**FAR, "op": "<"}, "Within", 1500, "ms")),
        ("CheckValue /odom age > 0.03", {**FAR, "property": "age", "value": 0.03}),
        (
            "CheckValue /gripper rate < 4.99",
            {**FAR, "topic": "/gripper", "property": "rate", "op": "<", "value": 4.99},
        ),
    ],
)
def test_it_holds_when_a_rule_with_it_holds(project: Path, words: str, condition: object) -> None:
    tried = try_rules(
        Draft(text=f"begin If {words} Then SetFrequency /scan 5 end"), project / "monday", lambda _: None
    )
    [block] = tried.blocks
    assert course_of(project, condition).condition.turns == block.turns


def test_a_time_is_beside_its_check(project: Path) -> None:
    course = course_of(project, timed(FAR, "For", 1.5, "s"))
    [since] = [t for t, truth in course.check.turns if truth is Truth.TRUE]
    [later] = [t for t, truth in course.condition.turns if truth is Truth.TRUE]
    assert later - since == pytest.approx(1.5, abs=0.01)


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"bag": "../monday"}, 403),
        ({"bag": "/etc"}, 403),
        ({"bag": "tuesday"}, 404),
        ({"condition": {**FAR, "topic": "no topic"}}, 422),
        ({"condition": {**FAR, "op": "about"}}, 400),
        ({"condition": {**FAR, "topic": "@machine", "property": "cpu"}}, 422),
        ({"condition": {"kind": "not", "term": FAR}}, 422),
        ({"condition": {**FAR, "property": "pose_y > 2) Then SetFrequency /odom 1 EndIf //"}}, 422),
    ],
)
def test_what_is_no_check_of_the_project_is_refused(
    page: Page, change: dict[str, object], status: int
) -> None:
    assert page.post("/api/check/course", {"bag": "monday", "condition": FAR, **change}).status == status


@pytest.mark.parametrize(
    ("check", "words", "held_s"),
    [
        (
            {"topic": "/mode", "property": "data", "value": '"docking"'},
            ["driving", "docking", "charging"],
            4.0,
        ),
        ({"topic": "/diagnostics", "property": 'status["lidar front"].level', "value": 2}, [], 1.0),
        ({"topic": "/gripper", "property": "holds", "value": "true"}, ["true"], 12.0),
    ],
)
def test_words_that_a_check_read_stand_in_the_place_of_a_curve(
    tmp_path: Path, check: dict[str, object], words: list[str], held_s: float
) -> None:
    PROJECTS["modes"](tmp_path)
    course = course_of(tmp_path, {"kind": "check", "op": "=", **check})
    assert [word for _, word in course.words if word is not None] == words
    turns = course.condition.turns
    ends = [*(t_s for t_s, _ in turns[1:]), course.duration_s]
    held = [end - t_s for (t_s, truth), end in zip(turns, ends, strict=True) if truth is Truth.TRUE]
    assert held == pytest.approx([held_s], abs=0.3)
