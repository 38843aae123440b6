# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A parameter that rules set is afterwards what it was before, whatever nodes and others do meanwhile."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smarttestudo.actions.parameter_setter import RETRY_AFTER_S, ParameterSetter
from smarttestudo.actions.restore_file import RestoreFile, RestoreFileError
from smarttestudo.domain.action import ActionDecision, ActionEvent, ActionKind, ActRequest, SetValue
from smarttestudo.domain.parameter import Got, SilentNodeError, Values, WasSet


class Camera:
    """A node with parameters, which answers when it is told to."""

    def __init__(self, **values: Any) -> None:
        self.values = values
        self.is_there = True
        self.refuses = ""
        self.waiting: list[tuple[Any, ...]] = []

    def get(self, _node: str, names: Sequence[str], got: Got) -> None:
        self.waiting.append((got, names, None))

    def set(self, _node: str, values: Values, was_set: WasSet) -> None:
        self.waiting.append((was_set, None, values))

    def answer(self) -> None:
        """Answer one request."""
        answered, names, values = self.waiting.pop(0)
        if not self.is_there:
            answered(SilentNodeError("the node did not answer within 5 s", place="/camera"))
        elif names is not None:
            answered({name: self.values.get(name) for name in names})
        elif self.refuses:
            answered(dict.fromkeys(values, self.refuses))
        else:
            self.values.update(values)
            answered({})

    def answer_all(self) -> None:
        while self.waiting:
            self.answer()


class Run:
    """A run with one setter, which may be killed at any moment."""

    def __init__(self, camera: Camera, path: Path) -> None:
        self.camera = camera
        camera.waiting = []
        self.told: list[str] = []
        self.now_s = 0.0
        file = RestoreFile(path)
        self.setter = ParameterSetter(camera, file, self.tell, lambda: self.now_s)
        self.setter.restore(file.read())

    def tell(self, decision: ActionDecision, event: ActionEvent, detail: str) -> None:
        self.told.append(f"{decision.action}: {event.value}: {detail}")

    def take(self, value: SetValue | None) -> None:
        action = ActRequest(kind=ActionKind.SET_PARAMETER, target="/camera", parameter="quality", value=value)
        event = ActionEvent.END if value is None else ActionEvent.BEGIN
        self.setter.take(ActionDecision(t_s=0, stamp_ns=0, event=event, action=action))

    def do(self, value: SetValue | None) -> str:
        self.take(value)
        self.camera.answer_all()
        return self.told[-1]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "state" / "before.json"


def test_it_is_set_and_given_back(path: Path) -> None:
    run = Run(Camera(quality=90), path)
    assert run.do(40) == "SetParameter /camera quality 40: done: it was 90"
    assert run.camera.values["quality"] == 40
    assert run.do(60) == "SetParameter /camera quality 60: done: it was 40"
    assert run.do(None) == "SetParameter /camera quality: done: it is 90 again"
    assert run.camera.values["quality"] == 90
    assert RestoreFile(path).read() == []


def test_a_whole_number_becomes_what_the_parameter_is(path: Path) -> None:
    run = Run(Camera(quality=0.5), path)
    run.do(1)
    assert repr(run.camera.values["quality"]) == "1.0"


def test_what_the_node_lacks_refuses_or_cannot_give_back_is_said(path: Path) -> None:
    run = Run(Camera(), path)
    assert run.do(40).endswith("failed: the node has no such parameter, or it is not set")
    run = Run(Camera(quality=("a", "b")), path)
    assert run.do(40).endswith("failed: it is a list, which could not be given back")
    run = Run(Camera(quality=90), path)
    run.camera.refuses = "read-only;\x1b[2J"
    assert run.do(40).endswith("failed: refused: read-only;\x1b[2J")
    assert run.do(None).endswith("done: nothing was set")
    assert run.camera.values["quality"] == 90


def test_a_value_of_somebody_else_is_left_alone(path: Path) -> None:
    run = Run(Camera(quality=90), path)
    run.do(40)
    run.camera.values["quality"] = 55
    assert run.do(None).endswith("left alone: it is 55, which was not set here")
    assert run.camera.values["quality"] == 55
    run.do(40)
    run.camera.values["quality"] = 66
    assert run.do(50).endswith("left alone: it is 66, which was not set here")
    assert run.do(None).endswith("done: nothing was set")
    assert run.camera.values["quality"] == 66


def test_a_node_that_vanishes_is_said_once_and_its_value_given_back_when_it_returns(path: Path) -> None:
    run = Run(Camera(quality=90), path)
    run.do(40)
    run.camera.is_there = False
    assert run.do(None) == "SetParameter /camera quality: failed: the node did not answer within 5 s"
    told = len(run.told)
    for _ in range(5):
        run.now_s += RETRY_AFTER_S
        run.setter.poll()
        run.camera.answer_all()
    assert len(run.told) == told
    run.camera.is_there = True
    run.now_s += RETRY_AFTER_S
    run.setter.poll()
    run.camera.answer_all()
    assert run.told[-1].endswith("done: it is 90 again")


def test_a_node_that_hangs_gets_the_last_value_that_was_decided(path: Path) -> None:
    run = Run(Camera(quality=90), path)
    for value in (40, 50, None, 60):
        run.take(value)
    run.camera.answer_all()
    assert run.camera.values["quality"] == 60
    assert run.told == [
        "SetParameter /camera quality 50: failed: the node was busy until the next change",
        "SetParameter /camera quality 40: done: it was 90",
        "SetParameter /camera quality 60: done: it was 40",
    ]


def test_without_a_place_to_remember_nothing_is_set(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    run = Run(Camera(quality=90), tmp_path / "before.json")
    run.setter = ParameterSetter(run.camera, RestoreFile(blocked / "x.json"), run.tell, lambda: 0.0)
    assert "cannot be written" in run.do(40)
    assert run.camera.values["quality"] == 90
    run.setter = ParameterSetter(run.camera, RestoreFile(None), run.tell, lambda: 0.0)
    assert "name one with --restore-file" in run.do(40)


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{", '{"parameters": [1]}', '{"parameters": [{"node": "/a"}]}', "[" * 100_000, "\0"],
)
def test_a_file_that_is_none_is_said(text: str, path: Path) -> None:
    path.parent.mkdir()
    path.write_text(text)
    with pytest.raises(RestoreFileError, match=r"before\.json: error: what parameters were before"):
        RestoreFile(path).read()


@cache
def lives() -> st.SearchStrategy[list[list[tuple[SetValue | None, int]]]]:
    """Of each run what was decided, and how many answers came before the next; it is killed at its end."""
    values = st.sampled_from([40, 41, 90, None])
    return st.lists(st.lists(st.tuples(values, st.integers(0, 3)), max_size=6), max_size=6)


@given(lives())
@settings(max_examples=300, deadline=None)
def test_whatever_was_decided_and_whenever_runs_are_killed_it_is_what_it_was(
    runs: list[list[tuple[SetValue | None, int]]],
) -> None:
    camera = Camera(quality=90)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "before.json"
        for decided in runs:
            run = Run(camera, path)
            for value, answers in decided:
                run.take(value)
                for _ in range(min(answers, len(camera.waiting))):
                    camera.answer()
        run = Run(camera, path)
        run.setter.give_all_back()
        camera.answer_all()
        assert (camera.values, RestoreFile(path).read(), run.setter.left) == ({"quality": 90}, [], ())
