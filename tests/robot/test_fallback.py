# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A run in virtual time while it has no valid rules: what it relays, how often, and what it says."""

from __future__ import annotations

import heapq
import itertools
import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from language.rule_strategies import rule_files
from language.written_rules import Word, words_of
from robot.memory_link import MemoryLink
from robot.small_graph import SmallGraph
from smarttestudo.domain.decision import AnyDecision, about_rates
from smarttestudo.domain.errors import RuleFileError, TestudoError, UsageError
from smarttestudo.domain.names import STATUS_TOPIC, resolve_topic
from smarttestudo.domain.parameter import Accept, Parameter, ParameterValue
from smarttestudo.domain.robot import PollGraph, Qos
from smarttestudo.loop.input_log import input_log
from smarttestudo.replays.inputs import replay_inputs
from smarttestudo.robot.decisions import Decided
from smarttestudo.robot.fallback import readable_rates
from smarttestudo.robot.input_recorder import Note
from smarttestudo.robot.option import Settings
from smarttestudo.robot.run import run_live
from smarttestudo.robot.run_options import FALLBACK, RUN_OPTIONS, RunParameters
from smarttestudo.rules.rule_files import refuse_missing

SECOND = 1_000_000_000
TOPICS = ("/cam", "/imu", "/odom", "/scan")
BROKEN = """\
begin
  SetFrequency /odom 10
  SetFrequency /scan Off
  KeepAtLeast /imu 5
  If (CheckValue /odom pose_x > ) Then SetFrequency /cam Full EndIf
end
"""
READ = {"/cam": 1.0, "/imu": 5.0, "/odom": 10.0, "/scan": 1.0}
FULL = dict.fromkeys(TOPICS, math.inf)
GOOD = "begin SetFrequency /odom 3 end"
GRAPH, LINK, BOTH, DOMAIN = "graph", "link", "both", "domain"


class RunningRobot(SmallGraph):
    """A robot with four topics, whose run takes ``seconds`` in no time; ``steps`` happen on their seconds."""

    def __init__(self, steps: Mapping[int, Callable[[RunningRobot], object]], where: str) -> None:
        super().__init__()
        self.has_output_domain = where in {DOMAIN, LINK}
        self.steps = steps
        self.statuses: list[dict[str, Any]] = []
        self.triggers: dict[str, Callable[[], str]] = {}
        self.parameters_accept: Accept | None = None
        self._timers: list[tuple[float, int, float, Callable[[], float | None]]] = []
        self._numbers = itertools.count()
        self._now_s = 0.0
        for topic in TOPICS:
            self.joins(topic, topic.encode())

    def declare(self, parameters: Sequence[Parameter], accept: Accept) -> Mapping[str, ParameterValue]:
        self.parameters_accept = accept
        return {one.name: one.value for one in parameters}

    def show(self, name: str, value: ParameterValue) -> None: ...

    def offer_trigger(self, name: str, act: Callable[[], str]) -> None:
        self.triggers[name] = act

    def text_publisher(self, topic: str, qos: Qos, *, goes_over_link: bool = True) -> Callable[[str], None]:
        if topic != STATUS_TOPIC:
            return super().text_publisher(topic, qos, goes_over_link=goes_over_link)
        return lambda text: self.statuses.append(json.loads(text))

    def every(self, period_s: float, act: Callable[[], float | None]) -> None:
        heapq.heappush(self._timers, (self._now_s, next(self._numbers), period_s, act))

    def poll_graph(self, poll: PollGraph) -> None: ...

    def now_ns(self) -> int:
        return 1_700_000_000 * SECOND + round(self._now_s * SECOND)

    def steady_ns(self) -> int:
        return round(self._now_s * SECOND)

    def wait(self, wake_ns: int | None, longest_s: float) -> None:
        before_s, self._now_s = self._now_s, self._now_s + longest_s
        for second, step in self.steps.items():
            if before_s < second <= self._now_s:
                step(self)
        while self._timers and self._timers[0][0] <= self._now_s:
            due_s, _, period_s, act = heapq.heappop(self._timers)
            after_s = act()
            next_s = due_s + (period_s if after_s is None else after_s)
            heapq.heappush(self._timers, (next_s, next(self._numbers), period_s, act))

    def targets_hz(self) -> dict[str, float]:
        """What each relayed topic is to have, by the last line of the log about it."""
        targets: dict[str, float] = {}
        for line in self.lines:
            if found := re.match(r"(/\w+): (?:.* → )?(Full|Off|[\d.]+ Hz|no longer relayed) ?\(", line):
                topic, rate = found.groups()
                targets.pop(topic, None)
                if rate != "no longer relayed":
                    targets[topic] = math.inf if rate == "Full" else float(rate.split()[0])
        return targets


def reload(robot: RunningRobot) -> object:
    try:
        return robot.triggers["~/reload"]()
    except TestudoError as error:
        return error


def push(text: str) -> Callable[[RunningRobot], object]:
    def step(robot: RunningRobot) -> object:
        assert robot.parameters_accept is not None
        return robot.parameters_accept({"rules_text": text})

    return step


def run(
    *rules: Path,
    where: str = LINK,
    fallback: ParameterValue = "auto",
    steps: Mapping[int, Callable[[RunningRobot], object]] | None = None,
    seconds: float = 4,
    note: Note | None = None,
    decided: Sequence[Decided] = (),
    **given: ParameterValue,
) -> RunningRobot:
    """A run of so many seconds."""
    robot = RunningRobot(steps or {}, where)
    options: dict[str, ParameterValue] = {
        "rules_file": tuple(map(str, rules)),
        "fallback": fallback,
        "output_topic": "{topic}" if where == LINK else "/testudo{topic}",
        **given,
    }
    run_live(
        RunParameters(robot, RUN_OPTIONS, options),
        robot,
        lambda: robot.steady_ns() >= seconds * SECOND,
        (),
        decided,
        note=note,
        link=MemoryLink() if where in {LINK, BOTH} else None,
    )
    return robot


@pytest.fixture
def broken(tmp_path: Path) -> Path:
    path = tmp_path / "rules.adirf"
    path.write_text(BROKEN, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("where", "fallback", "targets"),
    [
        (GRAPH, "auto", FULL),
        (LINK, "auto", READ),
        (DOMAIN, "auto", READ),
        (BOTH, "auto", READ),
        *((where, "full", FULL) for where in (GRAPH, LINK, DOMAIN, BOTH)),
        *((where, "off", {}) for where in (GRAPH, LINK, DOMAIN, BOTH)),
        # What YAML makes of "off".
        (LINK, False, {}),
    ],
)
def test_where_topics_go_and_the_option_say_what_is_relayed_by_a_broken_file(
    broken: Path, where: str, fallback: ParameterValue, targets: dict[str, float]
) -> None:
    robot = run(broken, where=where, fallback=fallback)
    assert robot.targets_hz() == targets
    assert robot.lines[0].startswith(f"{broken}:5:33: error: ")
    rules = robot.statuses[-1]["rules"]
    kind = "off" if not targets else "full" if targets == FULL else "readable"
    assert (rules["origin"], rules["fallback"]) == ("fallback", kind)
    assert rules["problem"].startswith(f"{broken}:5:33: error: ")


@pytest.mark.parametrize("where", [GRAPH, LINK, DOMAIN, BOTH])
def test_without_any_rules_everything_is_relayed_as_ever(where: str) -> None:
    robot = run(where=where)
    assert robot.targets_hz() == FULL
    assert robot.lines[0].endswith("relaying everything at Full until there are rules")


def test_the_log_says_that_a_topic_has_one_rate_on_the_graph_and_the_link(broken: Path) -> None:
    words = "all other topics have 1 Hz"
    assert run(broken, where=LINK).lines[0].endswith(words)
    assert run(broken, where=BOTH).lines[0].endswith(f"{words}, on this robot's graph as over the link")


def test_patches_are_thinned_only_where_a_rate_is_written(tmp_path: Path) -> None:
    patches = {"/map_updates": "map_msgs/msg/OccupancyGridUpdate", "/costmap": "nav2_msgs/msg/CostmapUpdate"}
    path = tmp_path / "rules.adirf"
    path.write_text(f"begin SetFrequency /costmap 2\n{BROKEN.removeprefix('begin')}", encoding="utf-8")

    def join(robot: RunningRobot) -> None:
        for topic, type_name in patches.items():
            robot.joins(topic, topic.encode(), type_name=type_name)

    joined = run(path, steps={1: join}, seconds=8)
    assert joined.targets_hz() == READ | {"/map_updates": math.inf, "/costmap": 2.0}


def test_a_mended_file_and_a_push_come_into_force_and_a_push_that_is_not_kept_goes(broken: Path) -> None:
    mended = run(broken, steps={2: lambda robot: (broken.write_text(GOOD), reload(robot))})
    assert mended.targets_hz() == {"/odom": 3.0}
    assert "fallback" not in mended.statuses[-1]["rules"]
    for fallback, back in (("auto", READ), ("off", {})):
        broken.write_text(BROKEN, encoding="utf-8")
        pushed = run(broken, fallback=fallback, steps={2: push(GOOD)}, seconds=8)
        assert pushed.targets_hz() == {"/odom": 3.0}
        reverted = run(broken, fallback=fallback, steps={2: push(GOOD)}, seconds=15)
        assert reverted.targets_hz() == back


def test_another_broken_text_is_read_anew_and_a_file_that_breaks_later_changes_nothing(broken: Path) -> None:
    def write(text: str) -> Callable[[RunningRobot], object]:
        return lambda robot: (broken.write_text(text, encoding="utf-8"), reload(robot))

    other = run(broken, steps={2: write("begin SetFrequency /scan 4 SetFrequency /odom x end")})
    assert other.targets_hz() == {"/cam": 1.0, "/imu": 1.0, "/odom": 1.0, "/scan": 4.0}
    later = run(broken, steps={2: write(GOOD), 3: write(BROKEN)}, seconds=5)
    assert later.targets_hz() == {"/odom": 3.0}
    assert "fallback" not in later.statuses[-1]["rules"]


def test_a_topic_that_appears_later_goes_out_at_its_rate_too(broken: Path) -> None:
    robot = run(broken, steps={2: lambda robot: robot.joins("/late", b"late")}, seconds=5)
    assert robot.targets_hz() == {**READ, "/late": 1.0}


def test_what_can_be_read_beside_a_file_that_cannot_counts(broken: Path, tmp_path: Path) -> None:
    broken.write_text(GOOD, encoding="utf-8")
    (tmp_path / "other.adirf").write_text("begin SetFrequency /scan 4 end // größer", encoding="latin-1")
    (tmp_path / "wide.adirf").write_text("begin SetFrequency /imu 6 end", encoding="utf-16")
    rates = {"/cam": 1.0, "/imu": 6.0, "/odom": 3.0, "/scan": 4.0}
    assert run(tmp_path).targets_hz() == rates
    assert run(*sorted(tmp_path.iterdir())).targets_hz() == rates


@pytest.mark.parametrize("text", ["", "begin end begin", "\0" * 10, "begin SetFrequency /odom Marginal end"])
def test_what_cannot_be_read_goes_out_at_one_hertz(broken: Path, text: str) -> None:
    broken.write_text(text)
    assert run(broken).targets_hz() == dict.fromkeys(TOPICS, 1.0)


def test_an_empty_folder_and_one_that_vanishes_are_waited_for(tmp_path: Path) -> None:
    folder = tmp_path / "rules"
    folder.mkdir()
    file = folder / "a.adirf"
    taken = run(folder, steps={2: lambda robot: (file.write_text(GOOD), reload(robot))})
    assert "the folder holds no rule files" in taken.lines[0]
    assert taken.targets_hz() == {"/odom": 3.0}
    file.write_text(BROKEN, encoding="utf-8")

    def vanish(robot: RunningRobot) -> object:
        file.unlink()
        folder.rmdir()
        return reload(robot)

    assert run(folder, steps={2: vanish}).targets_hz() == dict.fromkeys(TOPICS, 1.0)


def test_a_broken_profile_leaves_what_its_rules_say(broken: Path, tmp_path: Path) -> None:
    broken.write_text(GOOD)
    profile = tmp_path / "p.toml"
    profile.write_text("settle_s = -1")
    robot = run(broken, profile_file=str(profile))
    assert robot.targets_hz() == {**dict.fromkeys(TOPICS, 1.0), "/odom": 3.0}


def test_a_broken_rules_text_counts_as_a_broken_file(tmp_path: Path) -> None:
    assert run(rules_text=BROKEN).targets_hz() == READ


def test_exit_refuses_to_start_without_valid_rules(broken: Path) -> None:
    with pytest.raises(RuleFileError, match="expected a value"):
        run(broken, fallback="exit")
    with pytest.raises(RuleFileError, match="no rules are given"):
        run(fallback="exit")
    broken.write_text(GOOD)
    assert run(broken, fallback="exit").targets_hz() == {"/odom": 3.0}


@pytest.mark.parametrize("fallback", ["auto", "full", "off", "exit"])
def test_a_name_of_nothing_ends_the_start_with_what_may_be_meant(broken: Path, fallback: str) -> None:
    with pytest.raises(RuleFileError) as raised:
        run(broken, broken.with_name("ruls.adirf"), fallback=fallback)
    assert str(raised.value) == (
        f"{broken.with_name('ruls.adirf')}: error: there is no such file; did you mean {broken}?"
    )


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("warehuse.adirf", ["warehouse.adirf"]),
        ("Warehouse.adirf", ["warehouse.adirf"]),
        ("warehouse.adrif", ["warehouse.adirf"]),
        ("warehouse", ["warehouse.adirf"]),
        ("rule", ["rules"]),
        ("rule/warehouse.adirf", ["rules"]),
        ("missing.adirf", []),
        ("warehouse.adirf/rules", []),
    ],
)
def test_only_names_that_are_like_the_one_that_is_not_there_are_proposed(
    tmp_path: Path, name: str, meant: list[str]
) -> None:
    for one in ("warehouse.adirf", "wrong.adirf", "notes.txt"):
        (tmp_path / one).touch()
    (tmp_path / "rules").mkdir()
    with pytest.raises(RuleFileError) as raised:
        refuse_missing([tmp_path / name])
    paths = " or ".join(str(tmp_path / one) for one in meant)
    assert raised.value.remedy == (f"did you mean {paths}?" if meant else "check the path")


def test_a_file_that_pushed_rules_are_to_be_written_to_need_not_be_there(tmp_path: Path) -> None:
    robot = run(tmp_path / "new.adirf", allow_writing_rules=True)
    assert robot.targets_hz() == dict.fromkeys(TOPICS, 1.0)


def test_other_words_are_refused() -> None:
    with pytest.raises(UsageError, match="auto or full or off or exit"):
        Settings(RUN_OPTIONS, {FALLBACK.key: "on"})


def test_recorded_inputs_give_the_same_decisions(broken: Path, tmp_path: Path) -> None:
    live: list[AnyDecision] = []
    again: list[AnyDecision] = []
    with input_log(tmp_path / "inputs") as note:
        run(broken, note=note, decided=[live.extend])
    replay_inputs(tmp_path / "inputs", again.extend)
    assert again == live
    assert {one.topic: one.planned.rate.hz for one in about_rates(live)} == READ


@cache
def mutations() -> st.SearchStrategy[str]:
    """Texts of good rule files in which words were left out, doubled, moved, spoilt, or cut off."""

    def mutated(words: list[Word], edits: list[tuple[str, float]]) -> str:
        texts = [word.text for word in words]
        for edit, place in edits:
            at = int(place * len(texts))
            match edit:
                case "drop":
                    del texts[at : at + 1]
                case "double":
                    texts[at:at] = texts[at : at + 1]
                case "move":
                    texts.append(texts.pop(at) if texts else "")
                case "spoil":
                    texts[at : at + 1] = ["§"]
                case "cut":
                    del texts[at:]
        return " ".join(texts)

    places = st.floats(0, 1, exclude_max=True)
    edits = st.lists(
        st.tuples(st.sampled_from(["drop", "double", "move", "spoil", "cut"]), places), max_size=4
    )
    return st.builds(mutated, rule_files().map(lambda file: list(words_of(file))), edits)


@given(mutations())
def test_no_topic_goes_out_below_one_hertz_or_above_what_is_written_of_it(text: str) -> None:
    read = readable_rates({"rules.adirf": text}, resolve_topic)
    written = re.findall(r"(SetFrequency|KeepAtLeast) (\S+) (\S+)", text)
    for topic in {"/unnamed", *(resolve_topic(name) for _, name, _ in written if name != "Full")}:
        named = [number for _, name, number in written if resolve_topic(name) == topic]
        most_hz = max((math.inf if one == "Full" else hertz(one) for one in named), default=1.0)
        assert 1.0 <= read.rate(topic).hz <= max(1.0, most_hz)


def hertz(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0
