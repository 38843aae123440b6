# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The folders that the page's tests in gui/tests/page work in, by name."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from bags.bag_factory import (
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    localized_mission,
    message_of,
    small_mission,
    write_bag,
)
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


def _battery(folder: Path) -> None:
    """A recording of a robot that drives 24 m in 24 s while its battery falls from 30 to 10 %."""
    seconds, topic = 24, BagTopic("/battery_state", "sensor_msgs/msg/BatteryState")
    mission = small_mission(seconds)
    battery = (
        BagMessage(
            topic.name,
            START_NS + second * 1_000_000_000 + 3,
            cdr(topic.type_name, message_of(topic.type_name, percentage=0.3 - 0.2 * second / seconds)),
        )
        for second in range(seconds)
    )
    messages = sorted((*mission.messages, *battery), key=lambda message: message.stamp_ns)
    write_bag(folder / "monday", BagContent((*mission.topics, topic), tuple(messages)))


def _thesis(folder: Path) -> None:
    """The examples' rules, and the table of the thesis's Figure A.2 for a radio of 15 000 KB/s."""
    _examples(folder)
    for old in folder.glob("quality/*.toml"):
        old.unlink()
    entry = '[topics."{}"]\nmessage_kb = {:g}\ntiers_hz = {}\n'
    entries = [entry.format(topic, kb, list(tiers)) for topic, (kb, tiers) in golden.TOPICS.items()]
    (folder / "profile.toml").write_text("budget_kb_per_s = 15000\n" + "".join(entries))


def _monday(folder: Path) -> None:
    """A robot that drives 8 m along y in 8 s."""
    write_bag(folder / "monday", small_mission(8))


def _two_drives(folder: Path) -> None:
    """Of 8 s, and of 12 s."""
    _monday(folder)
    write_bag(folder / "longer", small_mission(12))


def _runs(folder: Path) -> None:
    """Three drives, the longer ones with a longer time without a picture, and one that cannot be read."""
    for name, seconds in (("a_short", 1), ("b_long", 4), ("d_middle", 2)):
        write_bag(folder / "runs" / name, small_mission(seconds))
    (folder / "runs" / "c_broken").mkdir()
    (folder / "runs" / "c_broken" / "metadata.yaml").write_text("no bag")


def _localized(folder: Path) -> None:
    """A robot that says where it is in its map."""
    write_bag(folder / "monday", localized_mission())


def _modes(folder: Path) -> None:
    """A robot that drives, docks after 4 s of 12 s, and charges from the 8th on, with a lidar that fails."""
    mission = small_mission(12)
    mode = BagTopic("/mode", "std_msgs/msg/String")
    diagnostics = BagTopic("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    status = "diagnostic_msgs/msg/DiagnosticStatus"
    words = [
        BagMessage(mode.name, START_NS + second * 1_000_000_000 + 3, cdr(mode.type_name, text))
        for second, text in (
            (at, message_of(mode.type_name, data=word))
            for at, word in ((0, "driving"), (4, "docking"), (8, "charging"))
        )
    ]
    states = [
        BagMessage(
            diagnostics.name,
            START_NS + second * 1_000_000_000 + 5,
            cdr(
                diagnostics.type_name,
                message_of(
                    diagnostics.type_name,
                    status=[
                        message_of(status, name="lidar front", level=2 if second == 6 else 0, message="beam"),
                        message_of(status, name="battery", level=0, message="full"),
                    ],
                ),
            ),
        )
        for second in range(12)
    ]
    messages = sorted((*mission.messages, *words, *states), key=lambda message: message.stamp_ns)
    write_bag(folder / "monday", BagContent((*mission.topics, mode, diagnostics), tuple(messages)))


def _plan(folder: Path) -> None:
    """An image, and no map that has its scale."""
    shutil.copy(EXAMPLES / "warehouse_map.png", folder / "plan.png")


def _inspection(folder: Path) -> None:
    """Rules in levels with their topic parameters."""
    (folder / "quality").mkdir()
    for name in ("inspection.adirf", "radio.toml"):
        shutil.copy(EXAMPLES / "quality" / name, folder / "quality")


def _sixty(folder: Path) -> None:
    """Rules about sixty topics with long names, and topic parameters that do not fit the link."""
    topics = [f"/warehouse_robot_{n:02}/camera_front_left/depth_registered/image_rect_raw" for n in range(60)]
    defaults = "".join(f"    SetFrequency {topic} Desirable\n" for topic in topics)
    busy = "".join(f"        SetFrequency {topic} Excessive\n" for topic in topics)
    rule = f'    Rule "All"\n    If CheckValue {topics[0]} rate > 1\n    Then\n{busy}    EndIf\n'
    (folder / "sixty.adirf").write_text(f"begin\n{defaults}\n{rule}end\n")
    entry = '[topics."{}"]\nmessage_kb = 900.5\nsource_hz = 30\ntiers_hz = [2, 5, 10, 15, 20, 25]\n'
    (folder / "sixty.toml").write_text("budget_kb_per_s = 1000.0\n" + "".join(map(entry.format, topics)))


PROJECTS: Mapping[str, Callable[[Path], None]] = MappingProxyType(
    {
        "battery": _battery,
        "empty": _empty,
        "examples": _examples,
        "inspection": _inspection,
        "localized": _localized,
        "modes": _modes,
        "monday": _monday,
        "plan": _plan,
        "radio": _radio,
        "runs": _runs,
        "sixty": _sixty,
        "thesis": _thesis,
        "two_drives": _two_drives,
    }
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
