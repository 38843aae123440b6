# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What testudo top shows."""

from __future__ import annotations

import io
import os
import pty
import select
import subprocess
import sys
import termios
from dataclasses import replace
from pathlib import Path

import pytest

from robot.status.statuses import ONE_OF_EACH, RELAYED, STATUS, WELL
from smarttestudo.cli.main import main
from smarttestudo.cli.terminal import key_presses
from smarttestudo.cli.top_table import Line, SortKey, Style, cropped, print_lines, summary_lines, topic_lines
from smarttestudo.domain.decision import BoundReason, Reason
from smarttestudo.domain.health import robot_health
from smarttestudo.domain.incident import IncidentState
from smarttestudo.domain.link import CommandTopic, LinkState, StreamCounts, TopicOnLink
from smarttestudo.domain.status import LossBeforeRelay, RulesInForce, RulesOrigin, Silence, TopicStatus

GOLDEN = Path(__file__).parent / "golden"
IN_BACKGROUND = Path(__file__).parents[2] / "in_background.py"


def look_of(topic: str) -> Style:
    (line,) = (line for line in topic_lines(STATUS, SortKey.TOPIC) if line.text.startswith(f"{topic} "))
    return line.style


def order_by(sort: SortKey) -> list[str]:
    return [line.text.split()[0] for line in topic_lines(STATUS, sort)[3:]]


@pytest.mark.parametrize("width", [80, 120])
def test_it_looks_like_this(width: int) -> None:
    lines = [*summary_lines(STATUS, width=width), Line(""), *topic_lines(STATUS, SortKey.TOPIC, width)]
    shown = "".join(f"{line.text}\n" for line in lines)
    assert shown == (GOLDEN / f"top-{width}.txt").read_text(encoding="utf-8")
    assert all(len(line.text) <= width for line in lines)


@pytest.mark.parametrize("width", [80, 120, None])
def test_what_is_lost_before_relay_is_a_state_and_lines_above_say_once_what_to_set(width: int | None) -> None:
    remedy = f"Fast DDS has too little shared memory: start /camera with FILE={'/of/a/package' * 6}"
    loss = LossBeforeRelay(percent=61.8, remedy=remedy)
    topics = {topic: replace(RELAYED, loss=loss) for topic in ("/left", "/right")}
    status = replace(WELL, topics=topics)
    lines = topic_lines(status, SortKey.TOPIC, width)
    shown = "lost before relay" if width == 80 else "lost before relay: 62 %"
    assert [line.text.rstrip().endswith(shown) for line in lines[3:5]] == [True, True]
    assert {line.style for line in lines[3:]} == {Style.WARN}
    said = summary_lines(status, width=width)[2:]
    assert "".join(line.text.replace(" ", "") for line in said) == (
        f"lost before relay: /left, /right; {remedy}".replace(" ", "")
    )
    assert width is None or all(len(line.text) <= width for line in [*lines, *said])


def test_the_rule_column_says_which_bound_holds_who_decided_it_and_what_is_in_doubt() -> None:
    reasons = {
        "position": BoundReason(reason=Reason.BLOCK, rule="Docking", line=7),
        "orientation": BoundReason(reason=Reason.UNKNOWN, rule="Low battery", line=9),
        "speed": BoundReason(reason=Reason.DEFAULT),
    }
    within = {"position": 0.05, "orientation": 2.0, "speed": 0.0}
    assert "default; position 0.05: Docking; orientation 2, in doubt: Low battery; speed 0: default" in (
        rule_of(replace(RELAYED, within=within, bound_reasons=reasons))
    )
    del reasons["position"], reasons["speed"]
    assert "default; orientation not bound, in doubt: Low battery" in (
        rule_of(replace(RELAYED, bound_reasons=reasons))
    )


def rule_of(topic: TopicStatus) -> str:
    return topic_lines(replace(STATUS, topics={"/odom": topic}), SortKey.TOPIC)[-1].text


def test_where_nobody_subscribes_to_anything_it_names_the_command_that_does() -> None:
    idle = replace(RELAYED, silence=Silence.NO_SUBSCRIBER, subscribers=0)
    gone = replace(idle, output="/testudo/estop", silence=Silence.NO_PUBLISHER)
    status = replace(STATUS, topics={"/estop": gone, "/imu": idle})
    line = Line("A relay runs while somebody subscribes to it, as testudo echo /testudo/imu does.")
    assert topic_lines(status, SortKey.TOPIC)[-1] == line
    assert line not in topic_lines(replace(status, topics={**status.topics, "/map": RELAYED}), SortKey.TOPIC)
    assert line not in topic_lines(replace(status, link=LinkState(is_connected=False)), SortKey.TOPIC)
    assert line not in topic_lines(replace(status, topics={"/estop": gone}), SortKey.TOPIC)


def test_what_recording_costs_has_a_line() -> None:
    state = IncidentState(held_bytes=12_340_000, memory_bytes=256_000_000, topics=5, open=1, recorded=3)
    (line,) = summary_lines(replace(WELL, incidents=state))[2:]
    assert line == Line("records 5 topics in 12.3 of 256 MB; incidents: 1 open, 3 recorded")
    with_ring = replace(state, ring_bytes=40_120_000, ring_max_bytes=5_000_000_000)
    (line,) = summary_lines(replace(WELL, incidents=with_ring))[2:]
    assert line.text.startswith("records 5 topics in 12.3 of 256 MB, on disk 40.1 of 5 000 MB; incidents: 1")
    failed = replace(state, failed=2, problem="/data: error: the disk is full")
    problem, line = summary_lines(replace(WELL, incidents=failed))[2:]
    assert line.text.endswith("1 open, 3 recorded, 2 failed")
    assert problem == Line("incidents cannot be written: /data: error: the disk is full", Style.WARN)


def test_what_is_accepted_of_operators_has_a_line_a_topic() -> None:
    accepted = (
        CommandTopic(topic="/a", type_name="x/msg/Y", delivered=1_200, too_old=3, refused=1, age_ms=44.4),
        CommandTopic(topic="/b"),
        CommandTopic(topic="/c", problem="nodes subscribe to it as\x1b[2J x and as y"),
    )
    lines = summary_lines(replace(STATUS, accepted=accepted))[-3:]
    assert lines == [
        Line("accepts /a: 1 200 delivered, 3 too old, 1 refused, the last 44 ms old"),
        Line("accepts /b: no node subscribes to it"),
        Line("accepts /c: nodes subscribe to it as\x1b[2J x and as y", Style.WARN),
    ]


def test_each_topic_has_the_look_of_its_health() -> None:
    assert look_of("/imu") is Style.PLAIN
    assert look_of("/cmd_vel") is look_of("/odom") is Style.QUIET
    assert look_of("/map") is look_of("/camera/image_raw/compressed") is Style.WARN
    assert look_of("/lidar") is Style.ERROR
    assert look_of("/estop") is look_of("/scan") is Style.STALE


def test_it_sorts_by_name_upwards_and_by_numbers_downwards() -> None:
    assert order_by(SortKey.TOPIC) == sorted(ONE_OF_EACH)
    assert order_by(SortKey.OUT)[0] == "/camera/image_raw/compressed"
    assert order_by(SortKey.ERROR)[0] == "/camera/image_raw/compressed"
    assert order_by(SortKey.TARGET)[0] == "/estop"
    assert order_by(SortKey.SOURCE)[-1] == "/estop"


def test_the_budget_and_its_trouble_are_said() -> None:
    assert summary_lines(STATUS)[1].text == "in 12 492.0 KB/s   out 946.0 KB/s of 1 000.0 (95 %)"
    tight = summary_lines(replace(STATUS, floors_break_budget=True))[2]
    assert tight == Line("the floors alone are more than the budget", Style.ERROR)
    assert "no budget" in summary_lines(replace(STATUS, budget_kb_per_s=None))[1].text
    linked = replace(STATUS, budget_kb_per_s=None, link=LinkState(is_connected=True))
    assert "out 946.0 KB/s, not limited   link: not the limit" in summary_lines(linked)[1].text
    assert "of 0.0" in summary_lines(replace(STATUS, budget_kb_per_s=0.0))[1].text


def test_a_link_says_how_much_it_takes_an_hour_and_what_the_radio_lost() -> None:
    counts = StreamCounts(sent=9, repaired=4, lost_replaced=2, lost_late=1, sent_bytes=3_000_000)
    topics = {"/odom": replace(RELAYED, on_link=TopicOnLink(counts=counts))}
    link = LinkState(is_connected=True, sent_bytes=3_900_000, report_bytes=100_000)
    linked = replace(STATUS, uptime_s=600.0, link=link, topics=topics)
    assert summary_lines(linked)[1].text.endswith(", 0 outages, 24.0 MB/h")
    heads, units, _, row = (line.text.split() for line in topic_lines(linked, SortKey.TOPIC)[:4])
    at = heads.index("Link")
    assert heads[at : at + 3] == ["Link", "Repaired", "Lost"]
    assert "MB/h" in units
    assert {"18.0", "4", "3"} <= {*row}
    # Robots of earlier versions do not count them.
    earlier = replace(linked, link=replace(link, sent_bytes=0))
    assert "MB/h" not in summary_lines(earlier)[1].text


def test_a_fallback_and_a_lost_runtime_are_said() -> None:
    fallback = replace(STATUS, rules=RulesInForce(origin=RulesOrigin.FALLBACK))
    assert summary_lines(fallback)[2].style is Style.ERROR
    (line,) = summary_lines(fallback, silent_s=7.0)[2:]
    remedy = "check that testudo run is running, and the network or radio"
    assert line == Line(f"silent for 7 s: {remedy}", Style.ERROR)


def test_what_is_wrong_with_a_node_is_said_in_the_words_of_its_diagnostics() -> None:
    rules = RulesInForce(origin=RulesOrigin.FALLBACK, problem="a.adirf:1:1: error: no rules")
    broken = replace(WELL, rules=rules, floors_break_budget=True, link=LinkState(is_connected=False))
    texts = [line.text for line in summary_lines(broken)]
    assert texts[2:] == [
        "the floors alone are more than the budget",
        "no valid rules: everything is relayed at full rate; mend the rule files, or push rules",
        "the rule files cannot be used as they are: a.adirf:1:1: error: no rules",
        "no operator is connected over the link",
    ]
    assert texts[2] == robot_health(broken).message


def test_pushed_rules_that_wait_are_said_to_end() -> None:
    line = Line("pushed rules: those before come back in 8 s, unless they are confirmed", Style.WARN)
    assert line in summary_lines(replace(STATUS, rules=replace(STATUS.rules, waits_s=8.3)))
    assert line not in summary_lines(replace(STATUS, rules=replace(STATUS.rules, waits_s=None)))


def test_names_from_the_network_cannot_move_the_cursor(capsys: pytest.CaptureFixture[str]) -> None:
    hostile = replace(STATUS, node="/\x1b[2J", topics={"/\x1b[31m": replace(RELAYED, rule="\r\n")})
    lines = [*summary_lines(hostile), *topic_lines(hostile, SortKey.TOPIC, 80)]
    print_lines(lines)
    printed = capsys.readouterr().out.split("\n")
    assert len(printed) == len(lines) + 2
    assert all(line.isprintable() for line in printed)


def test_a_low_window_says_how_much_is_missing() -> None:
    lines = [Line(str(number)) for number in range(10)]
    assert cropped(lines, 10) == lines
    assert [line.text for line in cropped(lines, 4)] == [
        *("0", "1", "2"),
        "… 7 more lines: a taller window, or --sort",
    ]


def test_in_a_pipe_there_are_plain_lines(capsys: pytest.CaptureFixture[str]) -> None:
    print_lines(topic_lines(STATUS, SortKey.TOPIC))
    printed = capsys.readouterr().out
    assert "\x1b" not in printed
    assert "the message type lidar_msgs/msg/Packet is not installed" in printed


def test_keys_are_read_without_enter_and_the_terminal_is_as_before(monkeypatch: pytest.MonkeyPatch) -> None:
    controller, terminal = pty.openpty()
    before = termios.tcgetattr(terminal)
    with os.fdopen(terminal) as stdin, os.fdopen(controller, "wb", buffering=0) as keyboard:
        monkeypatch.setattr(sys, "stdin", stdin)
        with key_presses() as pressed:
            assert pressed() == ""
            keyboard.write(b"xq")
            assert select.select([terminal], [], [], 40)[0]
            assert pressed().startswith("x")
        assert termios.tcgetattr(terminal) == before


def test_keys_are_read_without_enter_after_a_shell_had_stopped_the_process(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    controller, terminal = pty.openpty()
    as_a_shell_has_it = termios.tcgetattr(terminal)
    with os.fdopen(terminal) as stdin, os.fdopen(controller, "wb", buffering=0) as keyboard:
        monkeypatch.setattr(sys, "stdin", stdin)
        with key_presses() as pressed:
            termios.tcsetattr(terminal, termios.TCSADRAIN, as_a_shell_has_it)
            assert pressed() == ""
            keyboard.write(b"q")
            assert select.select([terminal], [], [], 40)[0]
            assert pressed() == "q"


def test_what_is_shown_elsewhere_goes_on_in_the_background_of_a_shell(tmp_path: Path) -> None:
    program = (
        "import sys; sys.stdout = open(sys.argv[1], 'w')\n"
        "from smarttestudo.cli.terminal import key_presses\n"
        "with key_presses() as pressed: print(repr(pressed()))"
    )
    shown = tmp_path / "shown.txt"
    command = [sys.executable, str(IN_BACKGROUND), sys.executable, "-c", program, str(shown)]
    subprocess.run(command, check=True, timeout=100)
    assert shown.read_text(encoding="utf-8") == "''\n"


def test_without_a_terminal_no_key_is_ever_pressed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("q"))
    with key_presses() as pressed:
        assert pressed() == ""


def test_json_without_once_is_a_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["top", "--json"]) == 2
    assert capsys.readouterr().err == "--json: error: --json goes with --once only; add --once\n"
