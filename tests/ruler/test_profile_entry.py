# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One entry of a profile, changed by a click on a finding."""

from __future__ import annotations

from pathlib import Path

from ruler.ruler_server import Page, served

RULES = """\
begin
    SetFrequency /camera/image_raw 10
    SetFrequency /camera/camera_info 3
end
"""
PROFILE = """\
# The radio of the patrol
[topics."/camera/image_raw"]
message_kb = 6220  # measured
[topics."/camera/camera_info"]
message_kb = 0.38
"""


def test_a_finding_is_mended_in_the_profile_which_keeps_its_comments(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        (finding,) = _findings(page, PROFILE)
        fix = finding["profile_fix"]
        assert fix["title"] == "pace /camera/camera_info with /camera/image_raw"
        text = _changed(page, PROFILE, fix)
        assert text == PROFILE + 'paced_with = "/camera/image_raw"\n'
        assert _findings(page, text) == []


def test_a_topic_that_the_profile_lacks_gets_a_table(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        entry = {"topic": "/tf", "key": "paced_with", "value": "/odom"}
        text = _changed(page, '[topics."/odom"]\n', entry)
        assert '[topics."/tf"]\npaced_with = "/odom"' in text


def test_an_entry_is_taken_out(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        entry = {"topic": "/camera/camera_info", "key": "paced_with", "value": None}
        assert _changed(page, PROFILE + 'paced_with = "/camera/image_raw"\n', entry) == PROFILE


def test_what_no_profile_can_hold_is_refused(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        entry = {"topic": "/tf", "key": "paced_with", "value": "two words"}
        assert page.post("/api/profile/entry", {"text": PROFILE, **entry}).status == 422


def _findings(page: Page, profile: str) -> list[dict[str, dict[str, str]]]:
    answer = page.post("/api/document", {"text": RULES, "profile_text": profile}).json
    found: list[dict[str, dict[str, str]]] = answer["findings"]
    return found


def _changed(page: Page, text: str, entry: dict[str, str | None] | dict[str, str]) -> str:
    request = {"text": text, "topic": entry["topic"], "key": entry["key"], "value": entry["value"]}
    return str(page.post("/api/profile/entry", request).json["text"])
