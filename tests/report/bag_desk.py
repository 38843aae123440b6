# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag``, run in a folder, and recordings for it."""

from __future__ import annotations

import csv
import json
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from bags.bag_factory import BagContent, small_mission, write_bag
from made_once import made_once
from smarttestudo.cli.main import main

MISSION = small_mission()
DECLARED = {"smarttestudo.declared_bytes": json.dumps({"/image": 6_220_000})}


@dataclass(frozen=True)
class Ran:
    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)

    @property
    def csv(self) -> list[dict[str, str]]:
        return list(csv.DictReader(self.out.splitlines()))


class Desk:
    """A folder in which ``testudo bag`` is run."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def bag(self, *arguments: str) -> Ran:
        self._capsys.readouterr()
        code = main(["bag", *arguments])
        captured = self._capsys.readouterr()
        return Ran(code, captured.out, captured.err)

    def refuses(self, *arguments: str) -> str:
        ran = self.bag(*arguments)
        assert (ran.code, ran.out) == (1, "")
        assert ran.err.count("\n") == 1
        return ran.err.rstrip("\n")


def thinned(every: int, rename: str = "{}", content: BagContent = MISSION) -> BagContent:
    """Each ``every``-th message of each topic, which get other names."""
    seen: Counter[str] = Counter()
    kept = []
    for message in content.messages:
        if seen[message.topic] % every == 0:
            kept.append(replace(message, topic=rename.format(message.topic)))
        seen[message.topic] += 1
    topics = [replace(topic, name=rename.format(topic.name)) for topic in content.topics]
    return BagContent(tuple(topics), tuple(kept))


def mission_bags(factory: pytest.TempPathFactory) -> Path:
    """The mission as ``sent``, with declared sizes as ``bag``, and each fifth of its messages as ``seen``."""

    def make(folder: Path) -> None:
        write_bag(folder / "sent", MISSION)
        write_bag(folder / "bag", MISSION, custom_data=DECLARED)
        write_bag(folder / "seen", thinned(5))

    return made_once(factory, "mission-bags", make)
