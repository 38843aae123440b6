# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the bounds of the rules were kept, between two recordings."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags.bag_factory import BagContent, write_bag
from pacing.reckoning.ros_messages import ODOMETRY, odometry, planar
from replays.replay_runs import ReplayRun, replay_content
from replays.test_replay_bounds import driven, recorded
from report.golden_files import assert_reads_as
from report.listed_decisions import listed_decisions
from smarttestudo.accuracy.arms import Receiver, with_later
from smarttestudo.accuracy.bounds import BoundLoss, BoundWatch
from smarttestudo.accuracy.samples import Message
from smarttestudo.cli.main import main
from smarttestudo.language.properties import gauges_for
from smarttestudo.pacing.reckoning.motion import Twist, Vector3

GOLDEN = Path(__file__).parent / "golden"
S = 1_000_000_000
CIRCLE = recorded("/odom", ODOMETRY, 20, 20, driven)
TOO_SLOW = "SetFrequency /odom 1 KeepWithin /odom position 0.3"

Sample = tuple[int, float]
BoundFrom = tuple[int, float | None]


def judged(
    sent: Sequence[Sample], received: Sequence[Sample], in_force: Sequence[BoundFrom], end_ns: int
) -> list[BoundLoss]:
    """What ``BoundWatch`` says of a number, shown in the order of the stamps."""
    changes = [(at, {} if bound is None else {"data": bound}) for at, bound in in_force]
    gauges = gauges_for("std_msgs/msg/Float64", ["data"])

    def message(at: int, value: float) -> Message:
        readings = tuple(gauge.read(b"", SimpleNamespace(data=value), at) for gauge in gauges)
        return Message(at, readings, digest=hash(str(value)))

    receiver = Receiver(gauges, [message(*one) for one in received], reckons=False)
    watch = BoundWatch(receiver, changes, {}, reckons=False, start_ns=0)
    for one, later in with_later(message(*one) for one in sent):
        watch.sent(one, later)
    return list(watch.losses("/level", {}, end_ns))


def in_force_at(in_force: Sequence[BoundFrom], at: int) -> float | None:
    return next((bound for start, bound in reversed(in_force) if start <= at), None)


def held_at(received: Sequence[Sample], at: int) -> float:
    return next((value for stamp, value in reversed(received) if stamp <= at), math.inf)


STAMPS = st.lists(st.integers(0, 60), unique=True, min_size=1, max_size=25).map(sorted)
BOUNDS = st.sampled_from([None, 0.0, 1.0, 2.0, 3.0])


@cache
@st.composite
def runs(draw: st.DrawFn) -> tuple[list[Sample], list[Sample], list[BoundFrom]]:
    sent = [(at, float(draw(st.integers(-4, 4)))) for at in draw(STAMPS)]
    received = [
        (at + draw(st.sampled_from([0, 0, 0, 1, 7])), value) for at, value in sent if draw(st.booleans())
    ]
    in_force = [(at, draw(BOUNDS)) for at in draw(STAMPS)[:5]]
    return sent, sorted(received, key=lambda one: one[0]), in_force


@given(runs())
def test_broken_and_worst_are_those_of_brute_force(
    run: tuple[list[Sample], list[Sample], list[BoundFrom]],
) -> None:
    sent, received, in_force = run
    end_ns = sent[-1][0]
    losses = judged(sent, received, in_force, end_ns)
    for loss in losses:
        errors = {
            at: abs(value - held_at(received, at))
            for at, value in sent
            if in_force_at(in_force, at) == loss.bound
        }
        assert loss.messages == len(errors)
        assert loss.broken == sum(error > loss.bound for error in errors.values())
        assert loss.is_held == (not loss.broken)
        assert loss.worst == max((error for error in errors.values() if error < math.inf), default=None)
        in_force_ns = sum(in_force_at(in_force, at) == loss.bound for at in range(end_ns))
        assert loss.in_force_s * S == pytest.approx(in_force_ns, abs=1e-6)
    bounds = {bound for at in range(end_ns + 1) if (bound := in_force_at(in_force, at)) is not None}
    assert {loss.bound for loss in losses} == bounds


@given(runs())
def test_broken_stretches_are_those_of_brute_force(
    run: tuple[list[Sample], list[Sample], list[BoundFrom]],
) -> None:
    """At every ns: is the last message sent since the bound came into force one that broke it?"""
    sent, received, in_force = run
    end_ns = sent[-1][0]
    broken: dict[float, list[int]] = {}
    for now in range(end_ns):
        bound = in_force_at(in_force, now)
        since = now
        while since and in_force_at(in_force, since - 1) == bound:
            since -= 1
        seen = [(at, value) for at, value in sent if since <= at <= now]
        if bound is not None and seen and abs(seen[-1][1] - held_at(received, seen[-1][0])) > bound:
            broken.setdefault(bound, []).append(now)
    for loss in judged(sent, received, in_force, end_ns):
        told = [
            now
            for stretch in loss.stretches
            for now in range(round(stretch.from_s * S), round(stretch.to_s * S))
        ]
        if loss.stretch_count == len(loss.stretches):
            assert told == broken.get(loss.bound, [])
            assert loss.broken == sum(stretch.messages for stretch in loss.stretches)
        assert round(loss.broken_s * S) == len(broken.get(loss.bound, []))


def compared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], run: ReplayRun, *options: str
) -> list[dict[str, Any]]:
    command = [
        "bag",
        "loss",
        str(tmp_path / "bag"),
        str(run.output),
        "--rules",
        str(tmp_path / "rules.adirf"),
    ]
    assert main([*command, *options, "--json"]) == 0
    bounds: list[dict[str, Any]] = json.loads(capsys.readouterr().out)["bounds"]
    return bounds


@pytest.mark.parametrize("predict", [(), ("/odom",)])
@pytest.mark.parametrize(
    "rules",
    [
        "SetFrequency /odom Full KeepWithin /odom position 0.1 KeepWithin /odom orientation 0",
        TOO_SLOW,
        "SetFrequency /odom 0.7 KeepWithin /odom position 0.02 KeepWithin /odom pose_x 0.01",
    ],
)
def test_what_a_replay_counts_is_what_its_recording_shows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], rules: str, predict: tuple[str, ...]
) -> None:
    run = replay_content(CIRCLE, rules, tmp_path, predict=frozenset(predict))
    options = ["--predict", *predict] if predict else []
    found = {one["property"]: one for one in compared(tmp_path, capsys, run, *options)}
    counted = run.outcome.topics["/odom"].bounds
    assert found.keys() == counted.keys()
    for name, (one,) in counted.items():
        told = found[name]
        assert (told["bound"], told["broken"]) == (one.bound, one.broken)
        assert told["worst"] == pytest.approx(one.worst, abs=1e-12)
        assert told["messages"] == len(CIRCLE.messages)


def test_dead_reckoning_is_judged_as_a_naive_unicycle_has_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It drives straight on for 5 s, then turns without a word: the unicycle goes on straight."""
    messages = recorded("/odom", ODOMETRY, 10, 10, turning)
    write_bag(tmp_path / "bag", messages)
    write_bag(tmp_path / "seen", BagContent(messages.topics, messages.messages[:1]))
    (tmp_path / "rules.adirf").write_text("begin SetFrequency /odom Full KeepWithin /odom position 0.05 end")
    command = ["bag", "loss", str(tmp_path / "bag"), str(tmp_path / "seen"), "--rules"]
    assert main([*command, str(tmp_path / "rules.adirf"), "--predict", "/odom", "--json"]) == 0
    (bound,) = json.loads(capsys.readouterr().out)["bounds"]
    errors = [math.dist(place(number / 10), (0.5 * number / 10, 0)) for number in range(100)]
    assert bound["broken"] == sum(error > 0.05 for error in errors)
    assert bound["worst"] == pytest.approx(max(errors), abs=1e-9)
    assert bound["stretch_count"] == 1
    (stretch,) = bound["stretches"]
    assert stretch["from_s"] == pytest.approx(next(n / 10 for n, e in enumerate(errors) if e > 0.05))
    assert stretch["to_s"] == pytest.approx(9.9)


def place(t_s: float) -> tuple[float, float]:
    return (0.5 * t_s, 0.0) if t_s <= 5 else (2.5, 0.5 * (t_s - 5))


def turning(stamp_ns: int, t_s: float) -> bytes:
    yaw = 0.0 if t_s <= 5 else math.pi / 2
    return odometry(stamp_ns, planar(*place(t_s), yaw), Twist(Vector3(0.5, 0, 0), Vector3(0, 0, 0)))


IN_A_BLOCK = """SetFrequency /odom 1
KeepWithin /odom position 2
Rule "far" If (CheckValue /odom pose_x > 3) Then KeepWithin /odom position 0.3 EndIf
SetFrequency /odom 1"""


def test_a_bound_of_a_block_is_judged_while_it_was_in_force(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = replay_content(CIRCLE, IN_A_BLOCK, tmp_path)
    (tmp_path / "decisions.jsonl").write_text(
        "".join(json.dumps(decision.to_json()) + "\n" for decision in run.decisions)
    )
    near, far = sorted(compared(tmp_path, capsys, run), key=lambda one: one["bound"])
    assert (near["bound"], far["bound"], far["held"]) == (0.3, 2, True)
    assert near["in_force_s"] + far["in_force_s"] == pytest.approx(19.95)
    # x > 3 m from 6.4 s on, and no more after the quarter of the circle that follows the next.
    assert near["stretches"][0]["from_s"] >= 10 * math.asin(0.6)
    counted = sorted(run.outcome.topics["/odom"].bounds["position"], key=lambda one: one.bound)
    assert [(one.bound, one.broken) for one in counted] == [
        (one["bound"], one["broken"]) for one in (near, far)
    ]
    assert [one.worst for one in counted] == pytest.approx([near["worst"], far["worst"]], abs=1e-12)
    given_decisions = compared(tmp_path, capsys, run, "--decisions", str(tmp_path / "decisions.jsonl"))
    assert sorted(given_decisions, key=lambda one: one["bound"]) == [near, far]


def test_the_table_of_bounds_reads_as_in_the_golden_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = replay_content(CIRCLE, TOO_SLOW, tmp_path)
    command = [
        "bag",
        "loss",
        str(tmp_path / "bag"),
        str(run.output),
        "--rules",
        str(tmp_path / "rules.adirf"),
    ]
    assert main(command) == 0
    text = capsys.readouterr().out
    table = text[text.index("Bounds of the rules") : text.index("Age of information")]
    assert_reads_as(GOLDEN / "bag-loss-bounds.txt", table)


def test_without_bounds_there_is_no_section(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = replay_content(CIRCLE, "SetFrequency /odom 1", tmp_path)
    command = ["bag", "loss", str(tmp_path / "bag"), str(run.output)]
    for options in ([], ["--rules", str(tmp_path / "rules.adirf")]):
        assert main([*command, *options, "--json"]) == 0
        assert "bounds" not in json.loads(capsys.readouterr().out)


def test_only_bounded_topics_can_be_predicted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = replay_content(CIRCLE, TOO_SLOW, tmp_path)
    rules = str(tmp_path / "rules.adirf")
    command = ["bag", "loss", str(tmp_path / "bag"), str(run.output), "--rules", rules, "--predict", "/tf"]
    assert main(command) == 2
    assert capsys.readouterr().err == (
        "--predict: error: no rule bounds /tf; name topics of a KeepWithin in --rules\n"
    )


def test_the_first_messages_that_nobody_received_are_said_to_show_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_bag(tmp_path / "bag", CIRCLE)
    write_bag(tmp_path / "seen", BagContent(CIRCLE.topics, CIRCLE.messages[40:]))
    (tmp_path / "rules.adirf").write_text(f"begin {TOO_SLOW} end")
    command = ["bag", "loss", str(tmp_path / "bag"), str(tmp_path / "seen"), "--rules"]
    assert main([*command, str(tmp_path / "rules.adirf"), "--json"]) == 0
    (bound,) = json.loads(capsys.readouterr().out)["bounds"]
    assert bound["stretches"] == [{"from_s": 0, "to_s": 2, "messages": 40, "worst": None}]
    assert (bound["broken"], bound["worst"]) == (40, 0)


def test_what_the_operator_got_before_the_robots_recording_began_is_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    messages = CIRCLE.messages
    write_bag(tmp_path / "bag", BagContent(CIRCLE.topics, messages[40:]))
    write_bag(tmp_path / "seen", BagContent(CIRCLE.topics, (*messages[:40], *messages[41:])))
    (tmp_path / "rules.adirf").write_text(f"begin {TOO_SLOW} end")
    command = ["bag", "loss", str(tmp_path / "bag"), str(tmp_path / "seen"), "--rules"]
    assert main([*command, str(tmp_path / "rules.adirf"), "--json"]) == 0
    (bound,) = json.loads(capsys.readouterr().out)["bounds"]
    # One message at 20 Hz is missing, of a robot at 0.5 m/s.
    assert (bound["broken"], bound["worst_at_s"]) == (0, 0)
    assert bound["worst"] == pytest.approx(0.025, rel=0.01)


def test_a_report_tells_of_the_bounds_too(tmp_path: Path) -> None:
    run = replay_content(CIRCLE, TOO_SLOW, tmp_path)
    page = tmp_path / "report.html"
    command = ["bag", "report", str(tmp_path / "bag"), str(run.output), "-o", str(page), "--rules"]
    assert main([*command, str(tmp_path / "rules.adirf")]) == 0
    text = page.read_text(encoding="utf-8")
    assert "/odom position 0.3 broken: 1.30 to 1.50 s (0.400 m); " in text
    assert "What an accuracy costs" in text


DOCKING = "SetFrequency /odom 1 If CheckValue /odom pose_x > 2 Then KeepWithin /odom position 0.01 EndIf"


def test_a_bound_of_an_earlier_run_in_the_decisions_file_is_in_force_no_more(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A run appends to the file: yesterday's ended within the zone, today's never came into it."""
    (tmp_path / "rules.adirf").write_text(f"begin {DOCKING} end")
    file = tmp_path / "decisions.jsonl"
    for day, speed in enumerate((1.0, 0.01)):

        def drives(stamp_ns: int, t_s: float, speed: float = speed) -> bytes:
            return odometry(stamp_ns, planar(speed * t_s, 0, 0))

        content = recorded("/odom", ODOMETRY, 20, 5, drives)
        later = tuple(replace(one, stamp_ns=one.stamp_ns + day * 86_400 * S) for one in content.messages)
        write_bag(tmp_path / f"sent{day}", BagContent(content.topics, later))
        command = ["replay", str(tmp_path / f"sent{day}"), "--rules", str(tmp_path / "rules.adirf")]
        one = tmp_path / "one.jsonl"
        assert main([*command, "--output", str(tmp_path / f"seen{day}"), "--decisions", str(one)]) == 0
        with file.open("a", encoding="utf-8") as opened:
            opened.write(one.read_text(encoding="utf-8"))
    capsys.readouterr()
    command = ["bag", "loss", str(tmp_path / "sent1"), str(tmp_path / "seen1"), "--decisions", str(file)]
    assert main([*command, "--rules", str(tmp_path / "rules.adirf"), "--json"]) == 0
    (bound,) = json.loads(capsys.readouterr().out)["bounds"]
    assert (bound["in_force_s"], bound["messages"], bound["broken"]) == (0, 0, 0)
    command = ["bag", "report", str(tmp_path / "sent1"), str(tmp_path / "seen1"), "--decisions", str(file)]
    report = tmp_path / "report.html"
    assert main([*command, "--rules", str(tmp_path / "rules.adirf"), "-o", str(report)]) == 0
    assert listed_decisions(report) == 1
