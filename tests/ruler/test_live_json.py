# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a page is told of a robot."""

from __future__ import annotations

import json
from dataclasses import replace

from robot.status.statuses import STATUS
from smarttestudo.domain.record import to_json
from smarttestudo.domain.remote_robots import RuleTexts
from smarttestudo.domain.status import status_from_text
from smarttestudo.ruler.job import answer_json
from smarttestudo.ruler.robots.view import live_model, robot_summaries
from smarttestudo.ruler.robots.watch import RuleWords, SeenRobot, words_of


def test_watching_says_what_it_takes_of_the_link() -> None:
    status = replace(STATUS, status_hz=20.0)
    seen = SeenRobot(status=status, heard_s=0.0, size_bytes=1500, words=RuleWords())
    assert live_model(seen).status_kb_per_s == 30


def test_a_robot_that_says_what_utf_8_cannot_is_told_with_question_marks() -> None:
    said = {
        **to_json(replace(STATUS, robot="b\udce9b")),
        "rules": {"files": ["/home/r\udce9gles.adirf"], "sha256": ""},
        "own \ud800": {"name \ud800": ["\ud800"]},
    }
    status = status_from_text(json.dumps(said))
    assert (status.robot, status.rules.paths) == ("b?b", ("/home/r?gles.adirf",))
    assert status.sections == {"own ?": {"name ?": ["?"]}}
    files = [{"name": "\ud800", "text": 'begin Rule "\ud800" If CheckValue /odom pose_x > 1 Then end'}]
    texts = RuleTexts.from_text(json.dumps({"sha256": "", "files": files, "full_names": {}}))
    assert texts.files[0][0] == "?"
    seen = SeenRobot(status=status, heard_s=0.0, size_bytes=1500, words=words_of(texts))
    assert "r?gles.adirf" in answer_json(live_model(seen)).decode()
    (summary,) = robot_summaries([seen], 0.0)
    assert "b?b" in answer_json(summary).decode()
