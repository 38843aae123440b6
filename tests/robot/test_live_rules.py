# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The rule files of a live run: read again and again."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

import pytest

from loop.loop_driver import SECOND, LoopDriver
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.names import DECISIONS_TOPIC, STATUS_TOPIC, is_output_name, resolve_topic
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.robot import is_visible
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.robot.decisions import decision_line
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.output_topics import OutputTopic, output_topics
from smarttestudo.robot.rules import LiveRuleFiles, Reading, RuleWatch
from smarttestudo.rules.rule_files import FileStates

GOOD = "begin\n  SetFrequency /imu 10\nend\n"


def files_at(
    *paths: Path, profile: Path | None = None, output_topic: str = "/testudo{topic}"
) -> LiveRuleFiles:
    return LiveRuleFiles(
        paths, profile, resolve=resolve_topic, output_topic=OutputTopic(pattern=output_topic)
    )


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


def test_hidden_topics_and_output_topics_are_known_by_name() -> None:
    assert not is_visible("/arm/_action/feedback")
    assert is_visible("/arm_1/joint_states")
    assert is_output_name("/testudo/imu", "/testudo{topic}")
    assert not is_output_name("/testudo_imu", "/testudo{topic}")
    assert is_output_name("/op/imu/thin", "/op{topic}/thin")
    assert not is_output_name("/imu", "{topic}")


def test_the_end_of_a_topic_reads_well_and_comes_back_from_a_log() -> None:
    planned = PlannedRate(rate=Rate(0.0), reason=Reason.RELOAD)
    end = Decision(
        t_s=1.0, stamp_ns=1, topic="/imu", from_rate=Rate(5.0), planned=planned, values={}, is_end=True
    )
    assert decision_line(end) == "/imu: no longer relayed (reload)"
    assert Decision.from_json(end.to_json()) == end


def test_outputs_in_a_domain_of_their_own_may_be_named_like_their_sources() -> None:
    output_topic = OutputTopic(pattern="{topic}", is_elsewhere=True)
    rules = LiveRuleFiles([], None, resolve=resolve_topic, output_topic=output_topic).check(GOOD)
    assert rules.output_topics == {"/imu": "/imu"}


def test_a_topic_that_would_be_relayed_to_itself_is_told_so() -> None:
    rules = compile_rules([parse("begin SetFrequency /any 5 end", "a.adirf").file], resolve_topic)
    with pytest.raises(UsageError, match="/any would be relayed to its own name; choose another pattern"):
        output_topics(rules, OutputTopic(pattern="{topic}"))
    assert output_topics(rules, OutputTopic(pattern="{topic}", is_elsewhere=True)) == {"/any": "/any"}


STANDARD_TOPICS = (
    "/rosout",
    "/parameter_events",
    "/diagnostics",
    "/diagnostics_agg",
    "/diagnostics_toplevel_state",
    "/tf",
    "/tf_static",
    "/clock",
    "/robot_description",
)
"""Topics that many nodes of a graph publish or read under this very name."""


@pytest.mark.parametrize(
    ("pattern", "is_elsewhere"), [("/testudo{topic}", False), ("/testudo{topic}", True), ("{topic}", True)]
)
def test_a_standard_topic_is_relayed_in_every_mode_of_output(pattern: str, is_elsewhere: bool) -> None:
    rules = compile_rules(
        [parse(f"begin {' '.join(f'SetFrequency {one} 1' for one in STANDARD_TOPICS)} end", "a").file],
        resolve_topic,
    )
    named = output_topics(rules, OutputTopic(pattern=pattern, is_elsewhere=is_elsewhere))
    assert named == {one: pattern.replace("{topic}", one) for one in STANDARD_TOPICS}


@pytest.mark.parametrize("topic", [STATUS_TOPIC, DECISIONS_TOPIC])
def test_what_this_node_alone_publishes_is_no_name_for_a_relayed_topic(topic: str) -> None:
    rules = compile_rules([parse(f"begin SetFrequency {topic} 1 end", "a").file], resolve_topic)
    with pytest.raises(UsageError, match="another topic's name"):
        output_topics(rules, OutputTopic(pattern="{topic}", is_elsewhere=True))


def output_names(text: str, remaps: dict[str, str]) -> dict[str, str]:
    output_topic = OutputTopic(resolve=lambda topic: remaps.get(topic, topic))
    return dict(
        LiveRuleFiles([], None, resolve=resolve_topic, output_topic=output_topic).check(text).output_topics
    )


def test_a_remapped_output_has_the_name_that_it_has_on_the_graph() -> None:
    assert output_names(GOOD, {"/testudo/imu": "/far/imu"}) == {"/imu": "/far/imu"}
    # ROS remaps a publisher's name once, and would take the first for the second.
    chained = {"/testudo/imu": "/imu_thin", "/imu_thin": "/other"}
    assert output_names(GOOD, chained) == {"/imu": "/testudo/imu"}


def test_an_output_that_is_remapped_to_a_name_in_use_is_an_error() -> None:
    with pytest.raises(UsageError, match="/imu would be relayed to its own name"):
        output_names(GOOD, {"/testudo/imu": "/imu"})
    both = "begin SetFrequency /imu 10 SetFrequency /scan 5 end"
    with pytest.raises(UsageError, match="/scan would be relayed to /far, as another topic is"):
        output_names(both, {"/testudo/imu": "/far", "/testudo/scan": "/far"})


def test_what_nobody_expected_of_the_files_is_an_error_once_and_they_are_watched_on(tmp_path: Path) -> None:
    class Odd(LiveRuleFiles):
        def states(self) -> FileStates:
            raise OverflowError("too\nlarge")

    files = Odd([tmp_path], None, resolve=resolve_topic, output_topic=OutputTopic(pattern="/testudo{topic}"))
    first, second = files.read(), files.read()
    assert str(first.error) == "error: unexpected OverflowError: too large"
    assert first.content == second.content, "so it is said once"
    watch = RuleWatch(files, first, LoopDriver(GOOD).loop.prepare)
    readings: list[Reading] = []
    with watch.running():
        while len(readings) < 2:
            readings += watch.readings()
    assert {str(reading.error) for reading in readings} == {str(first.error)}


@pytest.mark.parametrize("key", ["settle_s", "stale_after_s"])
def test_a_time_of_the_profile_that_is_longer_than_there_is_time_holds_for_ever(key: str) -> None:
    text = "begin SetFrequency /scan 9 If (CheckValue /odom pose_x > 1) Then SetFrequency /scan 1 EndIf end"
    topics = {"/odom": TopicProfile(stale_after_s=1e300 if key == "stale_after_s" else None)}
    robot = LoopDriver(text, Profile(topics=topics, settle_s=1e300 if key == "settle_s" else 0.0))
    robot.drive(0, 5.0, 0.0)
    robot.wait_until(1000 * 86_400 * SECOND)
    assert robot.rates() == {"/scan": 9.0 if key == "settle_s" else 1.0}
