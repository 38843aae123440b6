# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds over recordings with equal stamps: replay, accuracy, loss and a naive reading say the same."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags.bag_factory import START_NS, BagContent, BagMessage, BagTopic
from pacing.reckoning.ros_messages import ODOMETRY, TRANSFORMS, odometry, planar, transforms
from replays.replay_runs import ReplayRun, replay_content
from smarttestudo.accuracy.comparison import AccuracyRequest, NamedRules, View, compare_accuracy
from smarttestudo.accuracy.recorded_loss import LossQuestion, measure_loss
from smarttestudo.rules.rule_sets import load_rules

STEP_NS = 50_000_000
Places = Mapping[str, int]
"""Where a message says that each frame is, in m."""


def transforms_at(stamp_ns: int, places: Places) -> bytes:
    return transforms(stamp_ns, {name: planar(x_m, 0, 0) for name, x_m in places.items()})


def odometry_at(stamp_ns: int, places: Places) -> bytes:
    return odometry(stamp_ns, planar(next(iter(places.values())), 0, 0))


FORMS: Mapping[str, tuple[str, Callable[[int, Places], bytes], tuple[str, ...]]] = {
    "frames": (TRANSFORMS, transforms_at, ("arm", "base")),
    "odometry": (ODOMETRY, odometry_at, ("",)),
}


def drawn_messages(names: Sequence[str]) -> st.SearchStrategy[list[tuple[int, Places]]]:
    """Steps since the message before, most of them none, and what each says."""
    places = st.dictionaries(st.sampled_from(names), st.integers(0, 6), min_size=1)
    return st.lists(st.tuples(st.sampled_from([0, 0, 0, 1, 2, 5, 40]), places), min_size=2, max_size=25)


def recording_of(form: str, drawn: Sequence[tuple[int, Places]]) -> tuple[BagContent, list[Places]]:
    type_name, write, _ = FORMS[form]
    stamp_ns, messages = START_NS, []
    for number, (steps, places) in enumerate(drawn):
        stamp_ns += steps * STEP_NS
        # Each message differs from all others, as those of a robot do by their header.
        messages.append(BagMessage("/where", stamp_ns, write(stamp_ns + number, places)))
    return BagContent((BagTopic("/where", type_name),), tuple(messages)), [places for _, places in drawn]


def naive(
    sent: Sequence[BagMessage], places: Sequence[Places], received: Sequence[BagMessage], bound: float
) -> tuple[float | None, int]:
    """Worst and broken by one list of what happened: what was sent at a stamp comes when that is received."""
    number_of = {message.payload: number for number, message in enumerate(sent)}
    shown: dict[str, int] = {}
    waiting = list(received)
    errors = []
    for number, message in enumerate(sent):
        passes = False
        while waiting and waiting[0].stamp_ns <= message.stamp_ns:
            source = number_of[waiting[0].payload]
            if sent[source].stamp_ns == message.stamp_ns and source > number:
                break
            shown.update(places[source])
            passes = passes or source == number
            waiting.pop(0)
        found = [
            abs(x_m - shown[name]) if name in shown else math.inf for name, x_m in places[number].items()
        ]
        errors.append(0.0 if passes else max(found))
    return max((one for one in errors if one < math.inf), default=None), sum(one > bound for one in errors)


def all_opinions(
    content: BagContent, rules: str, folder: Path, *, reckons: bool
) -> tuple[ReplayRun, list[tuple[float | None, int]]]:
    """Worst and broken by replay, by accuracy and by loss."""
    predict = frozenset({"/where"} if reckons else ())
    run = replay_content(content, rules, folder, predict=predict)
    (record,) = run.outcome.topics["/where"].bounds["position"]
    rule_set = load_rules([folder / "rules.adirf"]).rule_set
    view = View.RECKONED if reckons else View.HOLD
    request = AccuracyRequest(
        bag=folder / "bag",
        rules=[NamedRules(name="rules", rule_set=rule_set, view=view)],
        progress=lambda _: nullcontext(lambda _: None),
    )
    compared = compare_accuracy(request)
    assert compared is not None
    shown = compared.arms[1].topics["/where"].properties["position"]
    question = LossQuestion(rule_set=rule_set, predict=predict)
    (lost,) = measure_loss(folder / "bag", run.output, question).bounds
    return run, [
        (record.worst, record.broken),
        (shown.error.worst if shown.error else None, shown.broken),
        (lost.worst, lost.broken),
    ]


def assert_all_agree(
    form: str, drawn: Sequence[tuple[int, Places]], *, ceiling: str, bound: float, reckons: bool
) -> None:
    content, places = recording_of(form, drawn)
    with tempfile.TemporaryDirectory() as folder:
        rules = f"{ceiling}KeepWithin /where position {bound}"
        run, opinions = all_opinions(content, rules, Path(folder), reckons=reckons)
        for opinion in opinions:
            assert opinion == pytest.approx(opinions[0])
        if not reckons:
            assert opinions[0] == naive(content.messages, places, run.on("/where"), bound)


@pytest.mark.parametrize("form", FORMS)
@settings(max_examples=20)
@given(st.data())
def test_replay_accuracy_loss_and_a_naive_reading_agree(form: str, data: st.DataObject) -> None:
    assert_all_agree(
        form,
        data.draw(drawn_messages(FORMS[form][2])),
        ceiling=data.draw(st.sampled_from(["", "SetFrequency /where 4 "])),
        bound=data.draw(st.sampled_from([0.5, 2.0])),
        reckons=data.draw(st.booleans()),
    )


@pytest.mark.parametrize("form", FORMS)
def test_a_message_is_compared_with_what_was_received_before_the_next_of_its_stamp(form: str) -> None:
    steps_and_places = [(0, 0), (40, 3), (0, 6), (0, 7)]
    drawn = [(steps, {FORMS[form][2][-1]: x_m}) for steps, x_m in steps_and_places]
    assert_all_agree(form, drawn, ceiling="", bound=2.0, reckons=False)
