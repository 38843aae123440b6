# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page offers to compare with: texts and named elements of a recording, and words of types."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from bags.bag_factory import START_NS, BagContent, BagMessage, BagTopic, cdr, message_of, write_bag
from ruler.page_projects import PROJECTS
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.type_definition import FieldType, TypeDefinition
from smarttestudo.language.known_types import KnownTypes
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.topics.known_fields import FieldKind, KnownField, known_fields
from smarttestudo.ruler.topics.recorded_words import (
    MAX_TEXTS,
    RecordedField,
    RecordedWordsRequest,
    recorded_words,
)


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("project")
    PROJECTS["modes"](folder)
    return folder


def fields_in(project: Path, topic: str, bag: str = "monday") -> Mapping[str, RecordedField]:
    words = recorded_words(RecordedWordsRequest(bag=bag, topic=topic), ProjectFolder(project), lambda _: None)
    return {field.path: field for field in words.fields}


def test_a_text_is_offered_as_it_was_in_the_recording(project: Path) -> None:
    fields = fields_in(project, "/mode")
    assert fields["data"].texts == ("charging", "docking", "driving")
    assert fields["data"].kind is FieldKind.TEXT


def test_elements_are_offered_by_name_behind_those_of_any(project: Path) -> None:
    fields = fields_in(project, "/diagnostics")
    assert fields["status[*].name"].texts == ("battery", "lidar front")
    assert fields['status["lidar front"].level'].kind is FieldKind.NUMBER
    paths = list(fields)
    assert paths.index("status[*].level") < paths.index('status["battery"].level')


def test_joints_are_offered_by_the_names_beside_them(tmp_path: Path) -> None:
    topic = BagTopic("/joint_states", "sensor_msgs/msg/JointState")
    joints = message_of(topic.type_name, name=["wheel left", 'a"b'], position=np.array([0.5, 1.0]))
    message = BagMessage(topic.name, START_NS, cdr(topic.type_name, joints))
    write_bag(tmp_path / "monday", BagContent((topic,), (message,)))
    assert {'position["wheel left"]', r'position["a\"b"]'} <= set(fields_in(tmp_path, topic.name))
    assert 'velocity["wheel left"]' not in fields_in(tmp_path, topic.name)


def test_true_and_false_are_told_from_numbers(project: Path) -> None:
    fields = fields_in(project, "/gripper")
    assert (fields["holds"].kind, fields["opening"].kind) == (FieldKind.TRUTH, FieldKind.NUMBER)


def test_texts_are_few_and_such_as_a_rule_can_say(tmp_path: Path) -> None:
    topic = BagTopic("/mode", "std_msgs/msg/String")
    texts = ["two\nlines", "x" * 1000, *(f"mode {number:03}" for number in range(200))]
    messages = tuple(
        BagMessage(topic.name, START_NS + at, cdr(topic.type_name, message_of(topic.type_name, data=text)))
        for at, text in enumerate(texts)
    )
    write_bag(tmp_path / "monday", BagContent((topic,), messages))
    found = fields_in(tmp_path, "/mode")["data"].texts
    assert len(found) == MAX_TEXTS
    assert all(text.startswith("mode ") for text in found)


def test_a_topic_that_the_recording_lacks_has_no_words(project: Path) -> None:
    assert fields_in(project, "/nothing") == {}
    with pytest.raises(TestudoError):
        fields_in(project, "/mode", "tuesday")


BATTERY = TypeDefinition(
    fields={
        "voltage": FieldType(name="float32"),
        "status": FieldType(name="uint8"),
        "health": FieldType(name="uint8"),
        "present": FieldType(name="boolean"),
        "location": FieldType(name="string"),
        "cells": FieldType(name="float32", is_array=True),
    },
    constants={"STATUS_FULL": 4.0, "HEALTH_DEAD": 3.0, "LIMIT": 5.0, "HOME": "dock"},
)
LIST = TypeDefinition(fields={"all": FieldType(name="p/msg/Battery", is_array=True)})
TYPES = KnownTypes(definitions={"p/msg/Battery": BATTERY, "p/msg/List": LIST})


def test_a_field_has_the_constants_that_belong_to_it() -> None:
    words = {field.path: field.words for field in known_fields(TYPES, "p/msg/Battery")}
    assert words == {
        "voltage": (),
        "status": ("STATUS_FULL",),
        "health": ("HEALTH_DEAD",),
        "present": ("true", "false"),
        "location": ("HOME",),
    }


def test_of_an_array_fields_of_any_element_are_offered() -> None:
    present = KnownField(path="all[*].present", kind=FieldKind.TRUTH, words=("true", "false"))
    assert present in known_fields(TYPES, "p/msg/List")
    assert known_fields(TYPES, "p/msg/Unknown") == ()
