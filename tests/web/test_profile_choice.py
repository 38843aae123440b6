# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which of a project's profiles a rule file is opened with, and what is said of one that lacks something."""

from __future__ import annotations

from pathlib import Path

import pytest

from web.ruler_server import Page, served

RULES = "begin SetFrequency /odom Desirable SetFrequency scan 3 end"
ENTRY = '[topics."{}"]\nmessage_kb = 1\ntiers_hz = [1, 2, 3, 4, 5, 6]\n'


def profile(*topics: str) -> str:
    return "budget_kb_per_s = 100\n" + "".join(ENTRY.format(topic) for topic in topics)


@pytest.mark.parametrize(
    ("profiles", "text", "chosen"),
    [
        ({"a.toml": ["/gps"], "b.toml": ["/odom"], "c.toml": ["/odom", "/scan"]}, RULES, "c.toml"),
        ({"a.toml": ["/odom", "/scan"], "patrol.toml": ["/gps"]}, RULES, "patrol.toml"),
        ({"deep/a.toml": ["/odom"], "z.toml": ["/odom"]}, RULES, "z.toml"),
        ({"deep/patrol.toml": ["/odom"], "z.toml": ["/odom", "/scan"]}, RULES, "z.toml"),
        ({"a.toml": ["/gps"]}, RULES, None),
        ({"a.toml": ["/gps"]}, "begin end", "a.toml"),
        ({"deep/a.toml": ["/gps"]}, "begin end", None),
        ({}, RULES, None),
    ],
)
def test_the_likeliest_profile_is_the_namesake_or_knows_the_most_topics(
    profiles: dict[str, list[str]], text: str, chosen: str | None, tmp_path: Path
) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "pyproject.toml").write_text("[project]\n")
    for name, topics in profiles.items():
        (tmp_path / name).write_text(profile(*topics))
    with served(tmp_path) as page:
        answer = page.post("/api/profile/for", {"text": text, "name": "patrol.adirf"})
    assert answer.json == {"name": chosen}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (profile("/scan"), ("/odom is in the rules but not", "add a row for /odom to their table")),
        (profile("/odom").replace("message_kb = 1\n", ""), ("needed of /odom", "fill in Message size (KB)")),
        (profile("/odom").partition("\n")[2], ("how much the link carries", "Total bandwidth (KB/s)")),
    ],
)
def test_what_a_profile_lacks_is_named_as_the_page_names_it(
    text: str, said: tuple[str, str], examples_page: Page
) -> None:
    rules = "begin SetFrequency /odom Desirable end"
    answer = examples_page.post("/api/optimize", {"text": rules, "profile_text": text})
    error = answer.json["error"]
    assert answer.status == 422
    assert said[0] in error["message"]
    assert said[1] in error["remedy"]
    assert "[topics" not in error["message"] + error["remedy"]
