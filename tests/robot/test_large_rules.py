# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Large rules are checked in a process of their own, and mean what they mean when checked here."""

from __future__ import annotations

import sys
import time
from functools import partial
from pathlib import Path

import pytest

from loop.loop_driver import SECOND, LoopDriver
from smarttestudo.domain.errors import RosError, RuleFileError, UsageError
from smarttestudo.domain.names import resolve_topic
from smarttestudo.robot.live_rules import LARGE_BYTES, LiveRules, are_large, check_live_rules
from smarttestudo.robot.output_topics import OutputTopic
from smarttestudo.robot.rule_checking import CheckRules, check_elsewhere
from smarttestudo.robot.rules import POLL_PERIOD_S, LiveRuleFiles, Reading, RuleWatch

TIMED = """
  If (CheckValue /odom pose_x > 3 For 2 s OR CheckValue scan range_min < 1 Until > 2)
  Then SetFrequency /camera 5 KeepWithin /odom position 0.1 Record "near" /odom Before 3 s After 1 s
  Else SetFrequency /camera 2 EndIf
"""
PROFILE = 'settle_s = 1.5\n[topics."camera"]\nstale_after_s = 3\n'


def zones(count: int, rate: int = 5) -> str:
    blocks = [
        f"If (CheckValue /odom pose_x > {place} AND CheckValue /odom pose_x < {place + 1}) "
        f"Then SetFrequency /scan {rate} Else SetFrequency /imu {1 + place % 5} EndIf"
        for place in range(count)
    ]
    return "\n".join(["begin SetFrequency /scan 1 SetFrequency /imu 1", TIMED, *blocks, "end"])


def check_of(text: str) -> CheckRules:
    return partial(check_live_rules, {"a.adirf": text}, Path("p.toml"), PROFILE)


def below_ada(topic: str) -> str:
    if topic == "/refused":
        raise RosError("this name is refused", place=topic)
    return f"/ada{resolve_topic(topic)}"


def elsewhere(check: CheckRules) -> LiveRules:
    return check_elsewhere(check, below_ada, lambda: False)


def test_they_mean_what_they_mean_here() -> None:
    check = check_of(zones(700))
    there, here = elsewhere(check), check(below_ada)
    assert here.is_large
    assert there == here
    assert (
        there.rule_set.relayed
        == here.rule_set.relayed
        == ("/ada/scan", "/ada/imu", "/ada/camera", "/ada/odom")
    )
    assert there.rule_set.signals == here.rule_set.signals
    assert there.names["scan"] == "/ada/scan"
    assert there.profile.settle_s == 1.5


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        (zones(3).replace("SetFrequency", "SetFrequenzy", 1), RuleFileError),
        (zones(3).replace("/imu", "/refused"), RosError),
    ],
)
def test_their_errors_are_those_of_a_check_here(text: str, kind: type[Exception]) -> None:
    with pytest.raises(kind) as here:
        check_of(text)(below_ada)
    with pytest.raises(kind) as there:
        elsewhere(check_of(text))
    assert str(there.value) == str(here.value)


def test_names_of_outputs_that_are_taken_are_an_error_of_usage() -> None:
    files = LiveRuleFiles([], None, resolve=resolve_topic, output_topic=OutputTopic(pattern="{topic}"))
    assert are_large({"a.adirf": zones(700)})
    with pytest.raises(UsageError, match="its own name"):
        files.check(zones(700))


def test_without_another_process_they_are_checked_here(monkeypatch: pytest.MonkeyPatch) -> None:
    check = check_of(zones(3))
    for program in ("/nowhere/python", "/bin/false"):
        monkeypatch.setattr(sys, "executable", program)
        assert elsewhere(check) == check(below_ada)


def test_nobody_waits_for_them_once_the_run_ends() -> None:
    start_s = time.monotonic()
    with pytest.raises(RuleFileError, match="not checked to the end"):
        check_elsewhere(check_of(zones(6000)), resolve_topic, lambda: True)
    assert time.monotonic() - start_s < 30


@pytest.mark.full
def test_a_watch_prepares_large_rules_beside_the_loop_and_frees_those_before(tmp_path: Path) -> None:
    path = tmp_path / "a.adirf"
    path.write_text(zones(700), encoding="utf-8")
    files = LiveRuleFiles([path], None, resolve=resolve_topic, output_topic=OutputTopic())
    assert files.size_bytes() > LARGE_BYTES
    driver = LoopDriver(zones(700))
    driver.drive(SECOND, 30.5, 0.0)
    watch = RuleWatch(files, files.read(), driver.loop.prepare)
    with watch.running():
        for turn, rate in enumerate((6, 7, 8), start=2):
            # At once, or who stands still meanwhile has left an empty file for two looks.
            written = tmp_path / "written"
            written.write_text(zones(700, rate), encoding="utf-8")
            written.replace(path)
            reading = next_reading(watch)
            assert reading.rules is not None
            assert reading.prepared is not None
            assert reading.prepared.fits(driver.loop.knowledge.rule_set, reading.rules.rule_set)
            driver.reload_rule_set(reading.rules.rule_set, prepared=reading.prepared)
            watch.free(reading.prepared)
            driver.drive(turn * SECOND, 30.5, 0.0)
            assert driver.rates()["/scan"] == rate


def next_reading(watch: RuleWatch) -> Reading:
    """The next one, which takes at least two looks."""
    while True:
        for reading in watch.readings():
            return reading
        time.sleep(POLL_PERIOD_S / 5)
