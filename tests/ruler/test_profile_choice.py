# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which of a project's profiles a rule file is opened with, and what is said of one that lacks something."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ruler.ruler_server import Page, served
from smarttestudo.cli.main import main

RULES = "begin SetFrequency /odom Desirable SetFrequency scan 3 end"
ENTRY = '[topics."{}"]\nmessage_kb = 1\ntiers_hz = [1, 2, 3, 4, 5, 6]\n'


def profile(*topics: str) -> str:
    return "budget_kb_per_s = 100\n" + "".join(ENTRY.format(topic) for topic in topics)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Two rule files, and two profiles of which b.toml knows more of their topics."""
    for name, text in (
        ("patrol.adirf", RULES),
        ("other.adirf", RULES),
        ("a.toml", profile("/odom")),
        ("b.toml", profile("/odom", "/scan")),
    ):
        (tmp_path / name).write_text(text)
    return tmp_path


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
    assert answer.json == {"name": chosen, "gone": None}


def test_a_profile_with_a_byte_order_mark_is_one(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(profile("/odom"), encoding="utf-8-sig")
    with served(tmp_path) as page:
        assert asked(page) == {"name": "a.toml", "gone": None}


def asked(page: Page, name: str = "patrol.adirf") -> object:
    return page.post("/api/profile/for", {"text": RULES, "name": name}).json


def test_what_was_chosen_for_rules_is_there_for_everybody(project: Path) -> None:
    with served(project) as page, served(project) as other:
        for wanted in ("b.toml", None, "a.toml"):
            answer = page.put("/api/profile/for", {"name": "patrol.adirf", "profile": wanted})
            assert (answer.status, asked(other)) == (200, {"name": wanted, "gone": None})
        assert asked(page, "other.adirf") == {"name": "b.toml", "gone": None}
        assert asked(page) == {"name": "a.toml", "gone": None}


def test_chosen_parameters_that_are_gone_are_named_and_taken_again_when_back(project: Path) -> None:
    with served(project) as page:
        page.put("/api/profile/for", {"name": "patrol.adirf", "profile": "a.toml"})
        (project / "a.toml").rename(project / "away")
        assert asked(page) == {"name": "b.toml", "gone": "a.toml"}
        (project / "away").rename(project / "a.toml")
        assert asked(page) == {"name": "a.toml", "gone": None}


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("patrol.adirf", "../a.toml"),
        ("patrol.adirf", "patrol.adirf"),
        ("../patrol.adirf", "a.toml"),
        ("a.toml", "a.toml"),
        ("patrol.adirf", ".testudo/settings.json"),
    ],
)
def test_rules_go_with_profiles_of_the_project_only(name: str, wanted: str, project: Path) -> None:
    with served(project) as page:
        assert page.put("/api/profile/for", {"name": name, "profile": wanted}).status == 403
    assert not (project / ".testudo").exists()


@pytest.mark.parametrize("profiles", ["[]", '{"patrol.adirf": 7}', '{"patrol.adirf": "/etc/passwd"}'])
def test_settings_that_somebody_else_wrote_choose_nothing_else(profiles: str, project: Path) -> None:
    (project / ".testudo").mkdir()
    (project / ".testudo" / "settings.json").write_text(f'{{"profiles": {profiles}}}')
    with served(project) as page:
        answer = page.post("/api/profile/for", {"text": RULES, "name": "patrol.adirf"})
        assert (answer.status, answer.json["name"]) == (200, "b.toml")


def test_what_was_chosen_for_rules_that_are_gone_is_forgotten(project: Path) -> None:
    with served(project) as page:
        page.put("/api/profile/for", {"name": "patrol.adirf", "profile": "a.toml"})
        (project / "patrol.adirf").unlink()
        page.put("/api/profile/for", {"name": "other.adirf", "profile": "a.toml"})
    kept = json.loads((project / ".testudo" / "settings.json").read_text())
    assert kept["profiles"] == {"other.adirf": "a.toml"}


def test_the_terminal_does_not_ask_what_was_chosen_on_the_page(
    project: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def said(wanted: str | None) -> tuple[int, str]:
        with served(project) as page:
            page.put("/api/profile/for", {"name": "patrol.adirf", "profile": wanted})
        return main(["check", str(project / "patrol.adirf")]), capsys.readouterr().out

    assert said(None) == said("a.toml")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (profile("/scan"), ("/odom is in the rules but not", "add a row for /odom to its table")),
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
