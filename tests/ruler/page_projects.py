# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The folders that the page's tests in gui/tests/page work in, by name."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from bags.bag_factory import small_mission, write_bag
from optimizer import golden
from ruler.ruler_server import EXAMPLES

RADIO = """\
# Our radio.
[topics."/odom"]
message_kb = 0.7
tiers_hz = [1, 2, 5, 10, 15, 20]
"""


def _empty(_: Path) -> None:
    """No file at all."""


def _examples(folder: Path) -> None:
    shutil.copytree(EXAMPLES, folder, dirs_exist_ok=True)


def _radio(folder: Path) -> None:
    """Topic parameters of one topic, and a recording that has it."""
    (folder / "radio.toml").write_text(RADIO)
    write_bag(folder / "monday", small_mission(8))


def _thesis(folder: Path) -> None:
    """The examples' rules, and the table of the thesis's Figure A.2 for a radio of 15 000 KB/s."""
    _examples(folder)
    for old in folder.glob("quality/*.toml"):
        old.unlink()
    entry = '[topics."{}"]\nmessage_kb = {:g}\ntiers_hz = {}\n'
    entries = [entry.format(topic, kb, list(tiers)) for topic, (kb, tiers) in golden.TOPICS.items()]
    (folder / "profile.toml").write_text("budget_kb_per_s = 15000\n" + "".join(entries))


PROJECTS: Mapping[str, Callable[[Path], None]] = MappingProxyType(
    {"empty": _empty, "examples": _examples, "radio": _radio, "thesis": _thesis}
)
"""Each writes its files into a folder that is there and empty."""


@dataclass(frozen=True, slots=True)
class MadeProjects:
    """Projects below ``folder``, each made once; tests get copies."""

    folder: Path

    def copy(self, name: str, target: Path) -> None:
        """Write the files of the project called ``name`` into ``target``, which is not there yet."""
        made = self.folder / name
        if not made.exists():
            made.mkdir(parents=True)
            PROJECTS[name](made)
        shutil.copytree(made, target)
