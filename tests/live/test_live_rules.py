# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rule files of a live run: read again and again."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

import pytest

from smarttestudo.composition.fallback import is_hidden
from smarttestudo.composition.live_decisions import decision_line
from smarttestudo.composition.live_rules import LiveRuleFiles, LiveRules
from smarttestudo.composition.monitored_topics import is_monitored
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.rate import Rate

GOOD = "begin\n  SetFrequency /imu 10\nend\n"


def files_at(
    *paths: Path, profile: Path | None = None, output_topic: str = "/testudo{topic}"
) -> LiveRuleFiles:
    return LiveRuleFiles(paths, profile, resolve=resolve_topic, output_topic=output_topic)


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def good(files: LiveRuleFiles) -> LiveRules:
    rules = files.read().rules
    assert rules is not None
    return rules


def sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def test_the_hash_is_that_of_all_rules_one_after_the_other(tmp_path: Path) -> None:
    one = written(tmp_path / "a.adirf", GOOD)
    assert good(files_at(one)).rules_hash == sha256(GOOD)
    text = GOOD.replace("imu", "scan")
    other = written(tmp_path / "b.adirf", text)
    assert (
        good(files_at(one, other)).rules_hash
        == good(files_at(tmp_path)).rules_hash
        == sha256(GOOD + GOOD.replace("imu", "scan"))
    )


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (GOOD[: len(GOOD) // 2], "{path}:2:3: error: "),
        ("", "{path}:1:1: error: "),
        (GOOD.replace("10", "Marginal"), "{path}:2:21: error: Marginal has no rate without a profile"),
        (GOOD.replace("10", "x").replace("imu", ""), "{path}:2:16: error: "),
    ],
)
def test_what_is_wrong_with_a_file_is_one_line_with_its_place(tmp_path: Path, text: str, line: str) -> None:
    path = written(tmp_path / "a.adirf", text)
    reading = files_at(path).read()
    assert reading.rules is None
    assert str(reading.error).startswith(line.format(path=path))
    assert "\n" not in str(reading.error)


def test_missing_files_and_none_at_all_are_said_and_not_raised(tmp_path: Path) -> None:
    assert "there is no such file" in str(files_at(tmp_path / "a.adirf").read().error)
    assert "name a rule file with --rules" in str(files_at().read().error)
    path, profile = written(tmp_path / "b.adirf", GOOD), written(tmp_path / "p.toml", "settle_s = -1")
    assert f"{profile}:1:1: error: " in str(files_at(path, profile=profile).read().error)


def test_outputs_named_like_sources_are_an_error_of_usage(tmp_path: Path) -> None:
    path = written(tmp_path / "a.adirf", GOOD)
    assert isinstance(files_at(path, output_topic="{topic}").read().error, UsageError)


def test_equal_text_is_equal_content_and_later_readings_have_greater_numbers(tmp_path: Path) -> None:
    files = files_at(written(tmp_path / "a.adirf", GOOD))
    first = files.read()
    written(tmp_path / "a.adirf", GOOD)
    second = files.read()
    assert second.number > first.number
    assert second.content == first.content
    written(tmp_path / "a.adirf", GOOD[:-8])
    third = files.read()
    assert third.content not in {first.content, str(third.error)}


def test_any_change_of_the_files_can_be_seen_without_reading_them(tmp_path: Path) -> None:
    path, profile = written(tmp_path / "a.adirf", GOOD), tmp_path / "p.toml"
    files = files_at(tmp_path, profile=profile)
    seen: list[Sequence[object]] = [files.states()]

    def changed() -> bool:
        seen.append(files.states())
        return seen[-1] not in seen[:-1]

    assert not changed()
    written(tmp_path / "new", GOOD.replace("10", "11")).replace(path)
    assert changed()
    written(tmp_path / "b.adirf", GOOD)
    assert changed()
    written(profile, "")
    assert changed()
    (tmp_path / "b.adirf").unlink()
    assert changed()
    assert not files_at(tmp_path / "absent" / "a.adirf").read().rules


def test_hidden_topics_and_monitored_ones_are_known_by_name() -> None:
    assert is_hidden("/arm/_action/feedback")
    assert not is_hidden("/arm_1/joint_states")
    assert is_monitored("/testudo/imu", "/testudo{topic}")
    assert not is_monitored("/testudo_imu", "/testudo{topic}")
    assert is_monitored("/op/imu/thin", "/op{topic}/thin")
    assert not is_monitored("/imu", "{topic}")


def test_the_end_of_a_topic_reads_well_and_comes_back_from_a_log() -> None:
    planned = PlannedRate(rate=Rate(0.0), reason=Reason.RELOAD)
    end = Decision(
        t_s=1.0, stamp_ns=1, topic="/imu", from_rate=Rate(5.0), planned=planned, values={}, is_end=True
    )
    assert decision_line(end) == "/imu: no longer relayed (reload)"
    assert Decision.from_json(end.to_json()) == end
