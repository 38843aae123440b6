# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Pipes, links that lead nowhere and empty names where a command reads a file."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from bags.bag_factory import small_mission, write_bag
from smarttestudo.cli.main import main
from smarttestudo.files.input_file import read_input


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a recording, rules, a pipe that nobody writes into and links in a circle."""
    write_bag(tmp_path / "sq", small_mission())
    (tmp_path / "a.adirf").write_text("begin\n  SetFrequency /odom 5\nend\n")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "map.yaml").write_text("image: pipe\nresolution: 0.1\norigin: [0, 0, 0]\n")
    (tmp_path / "piped").mkdir()
    os.mkfifo(tmp_path / "piped" / "metadata.yaml")
    (tmp_path / "one").symlink_to("two")
    (tmp_path / "two").symlink_to("one")
    monkeypatch.chdir(tmp_path)
    return tmp_path


NOBODY_WRITES = "it is a pipe without a writer"
NO_FILE = "it is a device or a pipe, not a file"
CIRCLE = "Too many levels of symbolic links"
CHECK_THE_PATH = "check the path and its permissions"


@pytest.mark.usefixtures("desk")
@pytest.mark.parametrize(
    ("command", "line"),
    [
        (("check", "pipe"), f"pipe: error: the rule file cannot be read: {NOBODY_WRITES}; give a rule file"),
        (("check", "one"), f"one: error: the rule file cannot be read: {CIRCLE}; give a rule file"),
        (("fmt", "pipe"), f"pipe: error: the rule file cannot be read: {NOBODY_WRITES}; give a rule file"),
        (
            ("check", "a.adirf", "--profile", "pipe"),
            f"pipe: error: the profile cannot be read: {NOBODY_WRITES}; give the path of a TOML file",
        ),
        (("bag", "info", "pipe"), f"pipe: error: cannot be read: {NO_FILE}; {CHECK_THE_PATH}"),
        (("bag", "info", "one"), f"one: error: cannot be read: {CIRCLE}; {CHECK_THE_PATH}"),
        (("bag", "report", "one"), f"one: error: cannot be read: {CIRCLE}; {CHECK_THE_PATH}"),
        (
            ("bag", "rates", "one", "two", "--figures", "f"),
            "\n".join(f"{one}: error: cannot be read: {CIRCLE}; {CHECK_THE_PATH}" for one in ("one", "two")),
        ),
        (
            ("bag", "info", "piped"),
            "piped: error: the folder holds no .db3 or .mcap file; "
            "give a rosbag2 folder, a .db3 or an .mcap file",
        ),
        (
            ("bag", "report", "sq", "--decisions", "pipe"),
            f"pipe: error: the decision log cannot be read: {NOBODY_WRITES}; "
            "give a file that --decisions wrote",
        ),
        (
            ("bag", "report", "sq", "--nav2-map", "pipe"),
            f"pipe: error: the map cannot be read: {NOBODY_WRITES}; "
            "give the .yaml file that nav2's map_saver wrote",
        ),
        (
            ("bag", "report", "sq", "--nav2-map", "map.yaml"),
            f"pipe: error: the map's image cannot be read: {NO_FILE}; "
            "give the .yaml file that nav2's map_saver wrote",
        ),
    ],
)
def test_what_is_no_file_is_one_line_and_is_not_waited_for(
    capsys: pytest.CaptureFixture[str], command: tuple[str, ...], line: str
) -> None:
    assert main(command) == 1
    assert capsys.readouterr().err == f"{line}\n"


def test_a_demo_takes_the_place_of_no_link_that_leads_nowhere(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["demo", "--seconds", "1", "--out", "one"]) == 1
    assert "exists and was not made by 'testudo demo'" in capsys.readouterr().err
    assert (desk / "one").is_symlink()


def test_a_pipe_is_read_while_somebody_writes(tmp_path: Path) -> None:
    text = b"begin\nend\n" * 50_000
    reading, writing = os.pipe()

    def write() -> None:
        with os.fdopen(writing, "wb") as file:
            file.write(text)

    writer = threading.Thread(target=write)
    writer.start()
    try:
        assert read_input(Path(f"/dev/fd/{reading}")) == text
    finally:
        os.close(reading)
        writer.join()


def test_no_more_is_read_than_was_asked_for(tmp_path: Path) -> None:
    (tmp_path / "text").write_text("0123456789")
    assert read_input(tmp_path / "text", 4) == b"0123"


@pytest.mark.parametrize(
    "command", [("bag", "rates", "sq", "--topics", ""), ("profile", "--bag", "sq", "--topics", "/odom", "")]
)
@pytest.mark.usefixtures("desk")
def test_an_empty_name_of_a_topic_is_wrong_usage(
    capsys: pytest.CaptureFixture[str], command: tuple[str, ...]
) -> None:
    assert main(command) == 2
    assert "the name of a topic is not empty; leave the option out for all" in capsys.readouterr().err


@pytest.mark.parametrize("command", [("fmt", ""), ("check", ""), ("bag", "info", ""), ("demo", "--out", "")])
def test_an_empty_name_is_not_this_folder(
    desk: Path, capsys: pytest.CaptureFixture[str], command: tuple[str, ...]
) -> None:
    before = (desk / "a.adirf").read_bytes()
    assert main(command) == 2
    assert "the name of a file or folder is not empty" in capsys.readouterr().err
    assert (desk / "a.adirf").read_bytes() == before
