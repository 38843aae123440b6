# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is found beside the text of rules: on the budget, and on topics that nobody knows."""

from __future__ import annotations

from pathlib import Path

import pytest

from ruler.ruler_server import Page
from smarttestudo.checks import CheckContext
from smarttestudo.domain.names import resolve_topic
from smarttestudo.language.parser import parse
from smarttestudo.rules.findings import all_findings
from smarttestudo.rules.profile_file import parse_profile
from smarttestudo.rules.rule_sets import known_types

PROFILE = """\
budget_kb_per_s = 1000
[topics."/camera"]
message_kb = 500
tiers_hz = [2, 4, 6, 8, 10, 15]
[topics."/odom"]
message_kb = 1
"""
CAMERA = "begin\n    SetFrequency /odom 10\n    SetFrequency /camera {}\nend\n"
RULE = "    If CheckValue /odom pose_x > 1\n    Then\n        SetFrequency /camera 3\n    EndIf\nend\n"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (CAMERA.format("Excessive"), "infeasible"),
        (CAMERA.format("1").replace("end\n", RULE), "situation-over-budget"),
        (CAMERA.format("Full"), "budget-not-proven"),
    ],
)
def test_the_page_says_what_the_command_line_says(examples_page: Page, text: str, code: str) -> None:
    profile = parse_profile(PROFILE, Path("profile.toml"))
    context = CheckContext(profile=profile, types=known_types(None, profile), resolve=resolve_topic)
    said = {(one.code, one.severity.value, one.message) for one in all_findings([parse(text, "a")], context)}
    both = [
        *examples_page.post("/api/document", {"text": text, "profile_text": PROFILE}).json["findings"],
        *surroundings(examples_page, text, PROFILE),
    ]
    assert code in {one["code"] for one in both}
    assert {(one["code"], one["severity"], one["message"]) for one in both} == said


def test_topics_that_nobody_knows_are_found_once(examples_page: Page) -> None:
    text = "begin SetFrequency /sacn 1 SetFrequency /odmo 1 SetFrequency /odom 1 end"
    known = "neither robot, recording nor profile has"
    said = [one["message"] for one in surroundings(examples_page, text, PROFILE, recorded=["/scan"])]
    # The checker tells of /odmo, which is one letter off.
    assert [message for message in said if "nor profile" in message] == [f"{known} /sacn"]
    assert not [
        one
        for one in surroundings(examples_page, text, PROFILE, recorded=["/sacn"])
        if known in one["message"]
    ]
    assert surroundings(examples_page, text, None) == []


def test_rules_with_errors_have_none(examples_page: Page) -> None:
    assert surroundings(examples_page, "begin SetFrequency end", PROFILE) == []


def surroundings(
    examples_page: Page, text: str, profile: str | None, recorded: list[str] | None = None
) -> list[dict[str, str]]:
    request = {"text": text, "profile_text": profile, "recorded_topics": recorded or []}
    found: list[dict[str, str]] = examples_page.post("/api/surroundings", request).json["findings"]
    return found
