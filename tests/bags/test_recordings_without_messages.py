# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Every command reads a recording that is honestly empty, and refuses one of which no message is left."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from bags.bag_factory import ODOM
from bags.recorded_by_others import (
    COUNT,
    ODOMETRY,
    Table,
    chunk,
    drive,
    odometry_at,
    stamp_of,
    write_metadata,
    write_records,
    write_tables,
)
from smarttestudo.bags.magic import ZSTD
from smarttestudo.cli.main import main

RULES = (
    "begin\nSetFrequency /odom 2\nKeepWithin /odom position 0.05\n"
    "If CheckValue /odom pose_x > 5 Then SetFrequency /odom 4 EndIf\nend\n"
)
ROWS = [(stamp_of(number), odometry_at(number)) for number in range(COUNT)]


def mcap_folder(folder: Path, *, promised: int = 0, files: int = 1, missing: int = 0) -> Path:
    names = [f"a_{number}.mcap" for number in range(files + missing)]
    for name in names[:files]:
        write_records(folder / name)
    return write_metadata(folder, names, {"/odom": (ODOM.type_name, promised)})


def table_folder(folder: Path, *, promised: int = 0) -> Path:
    write_tables(folder / "a_0.db3", [Table("/odom", ODOM.type_name, [])])
    topics = {"/odom": (ODOM.type_name, promised)}
    return write_metadata(folder, ["a_0.db3"], topics, storage="sqlite3")


def packed_junk(folder: Path) -> Path:
    """The metadata say that messages are packed one by one, and none is."""
    rows = [(stamp_of(number), b"\xff" * 40) for number in range(COUNT)]
    write_tables(folder / "a_0.db3", [Table("/odom", ODOM.type_name, rows)])
    packing: dict[str, Any] = {"compression_format": "zstd", "compression_mode": "MESSAGE"}
    topics = {"/odom": (ODOM.type_name, COUNT)}
    return write_metadata(folder, ["a_0.db3"], topics, storage="sqlite3", **packing)


def altered(path: Path, alter: Callable[[bytes], bytes]) -> Path:
    path.write_bytes(alter(path.read_bytes()))
    return path


def zeros_after(size: int) -> Callable[[bytes], bytes]:
    return lambda data: data[:size] + bytes(max(len(data) - size, 0))


def without_payloads(data: bytes) -> bytes:
    """The chunk is all zeros, and the summary still promises what was in it."""
    start = data.index(b"ros2") + 30
    end = data.rindex(b"ros2msg") - 200
    return data[:start] + bytes(end - start) + data[end:]


EMPTY: dict[str, Callable[[Path], Path]] = {
    "a closed file": lambda at: write_records(at / "a.mcap"),
    "a closed file with channels in front": lambda at: write_records(at / "a.mcap", *ODOMETRY),
    "a closed file without topics": lambda at: write_records(at / "a.mcap", described=()),
    "a table": lambda at: write_tables(at / "a.db3", [Table("/odom", ODOM.type_name, [])]),
    "a table without topics": lambda at: write_tables(at / "a.db3", []),
    "a folder of MCAP": mcap_folder,
    "a folder of two files": lambda at: mcap_folder(at, files=2),
    "a folder of SQLite": table_folder,
}
LOST: dict[str, Callable[[Path], Path]] = {
    "metadata promise messages of a closed file": lambda at: mcap_folder(at, promised=COUNT),
    "metadata promise rows": lambda at: table_folder(at, promised=COUNT),
    "the file with the messages is gone": lambda at: mcap_folder(at, promised=COUNT, missing=1),
    "a file of which nobody knows is gone": lambda at: mcap_folder(at, missing=1),
    "cut before the first message": lambda at: write_records(at / "a.mcap", *ODOMETRY, is_closed=False),
    "nothing but the magic": lambda at: altered(write_records(at / "a.mcap"), lambda data: data[:8]),
    "zeros after the header": lambda at: altered(
        write_records(at / "a.mcap", *chunk(*ODOMETRY, *drive())), zeros_after(80)
    ),
    "broken bytes for the chunk": lambda at: altered(
        write_records(at / "a.mcap", *chunk(*ODOMETRY, *drive(), frames=1)),
        lambda data: data.replace(ZSTD, b"\xff" * len(ZSTD)),
    ),
    "messages that are not packed as the metadata say": packed_junk,
    "zeros for the chunk": lambda at: altered(
        write_records(at / "a.mcap", *chunk(*ODOMETRY, *drive(), frames=1)), without_payloads
    ),
    "a cut table": lambda at: altered(
        write_tables(at / "a.db3", [Table("/odom", ODOM.type_name, ROWS)]),
        lambda data: data[: 2 * 4096 + 100],
    ),
    "zeros after the first page": lambda at: altered(
        write_tables(at / "a.db3", [Table("/odom", ODOM.type_name, ROWS)]), zeros_after(4096)
    ),
}
COMMANDS: dict[str, Sequence[str]] = {
    "info": ("bag", "info", "{bag}"),
    "rates": ("bag", "rates", "{bag}", "--latency"),
    "bandwidth": ("bag", "bandwidth", "{bag}"),
    "compare": ("bag", "compare", "{bag}", "{full}"),
    "compare with": ("bag", "compare", "{full}", "{bag}"),
    "loss": ("bag", "loss", "{bag}"),
    "loss from": ("bag", "loss", "{bag}", "{full}"),
    "loss to": ("bag", "loss", "{full}", "{bag}", "--rules", "{rules}"),
    "accuracy": ("bag", "accuracy", "{bag}", "--rules", "{rules}"),
    "report": ("bag", "report", "{bag}", "-o", "{out}/report.html"),
    "report from": ("bag", "report", "{bag}", "{full}", "-o", "{out}/from.html"),
    "report with": ("bag", "report", "{full}", "{bag}", "--rules", "{rules}", "-o", "{out}/pair.html"),
    "replay": ("replay", "{bag}", "--rules", "{rules}", "--output", "{out}/replayed"),
    "replay with report": (
        *("replay", "{bag}", "--rules", "{rules}", "--output", "{out}/with_report"),
        *("--report", "{out}/replay.html"),
    ),
    "check": ("check", "{rules}", "--bag", "{bag}"),
    "profile": ("profile", "--bag", "{bag}"),
    "profile from curve": ("profile", "--bag", "{bag}", "--from-curve"),
}


class Desk:
    """A folder with rules and a recording that is not empty, in which commands are run."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self._folder, self._capsys = folder, capsys
        (folder / "rules.adirf").write_text(RULES)
        (folder / "out").mkdir()
        self._full = write_records(folder / "full" / "full.mcap", *chunk(*ODOMETRY, *drive()))

    def codes(self, bag: Path, commands: Sequence[str] = tuple(COMMANDS)) -> dict[str, int]:
        return {name: self.run(bag, name)[0] for name in commands}

    def run(self, bag: Path, name: str, *more: str) -> tuple[int, str, str]:
        places = {"bag": bag, "full": self._full, "rules": self._folder / "rules.adirf"}
        words = [word.format(**places, out=self._folder / "out") for word in COMMANDS[name]]
        self._capsys.readouterr()
        code = main([*words, *more])
        captured = self._capsys.readouterr()
        return code, captured.out, captured.err


@pytest.fixture
def desk(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Desk:
    return Desk(tmp_path, capsys)


@pytest.mark.parametrize("kind", EMPTY)
def test_an_empty_recording_is_read_by_every_command_with_a_note(
    kind: str, tmp_path: Path, desk: Desk
) -> None:
    bag = EMPTY[kind](tmp_path / "bag")
    # Without a topic there is no pair.
    for name in COMMANDS:
        code, _, said = desk.run(bag, name)
        assert code == 0, (name, said)
        assert f"note: {bag}: the recording holds no message\n" in said, (name, said)


@pytest.mark.parametrize("kind", LOST)
def test_a_recording_of_which_nothing_can_be_read_is_an_error_of_every_command(
    kind: str, tmp_path: Path, desk: Desk
) -> None:
    bag = LOST[kind](tmp_path / "bag")
    for name in COMMANDS:
        code, printed, said = desk.run(bag, name)
        assert (code, said.count("error: ")) == (1, 1), (name, said)
        assert said.startswith(str(bag)), (name, said)
        assert said.count("\n") == 1, (name, said)
        assert printed == "", name


def test_an_empty_recording_has_no_time_and_no_numbers(tmp_path: Path, desk: Desk) -> None:
    bag = EMPTY["a closed file"](tmp_path / "bag")
    info = json.loads(desk.run(bag, "info", "--json")[1])
    assert (info["start"], info["end"], info["duration_s"], info["readable_percent"]) == (None, None, 0, 100)
    assert (info["topics"]["/odom"]["messages"], info["topics"]["/odom"]["mean_hz"]) == (0, None)
    assert "1970" not in desk.run(bag, "info")[1]


def test_where_nothing_was_received_everything_was_lost(tmp_path: Path, desk: Desk) -> None:
    bag = EMPTY["a table"](tmp_path / "bag")
    compared = json.loads(desk.run(bag, "compare with", "--json")[1])
    assert compared["total"]["bandwidth_change_percent"] == -100
    lost = json.loads(desk.run(bag, "loss to", "--json")[1])
    assert lost["topics"]["/odom"]["received"] == {"messages": 0, "bytes": 0, "age": None}
    assert len(lost["notices"]) == 1
