# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Which recordings a text on a command line names."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from smarttestudo.bags.many.recordings import RecordingPair, find_recordings, pair_recordings
from smarttestudo.domain.errors import RecordingError

NOBODY = 65534


@pytest.fixture
def fleet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Recordings of two days, one a folder of rosbag2, one a file, and what else lies around."""
    monkeypatch.chdir(tmp_path)
    for name in (
        *("fleet/monday/r2/metadata.yaml", "fleet/monday/r1/r1_0.mcap", "fleet/tuesday/r1/r1.db3.zstd"),
        *("fleet/notes.txt", "fleet/empty/notes.txt", "files/a.mcap", "files/b.mcap", "files/c.txt"),
    ):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return tmp_path


def named(text: str) -> list[str]:
    return [str(found.path) for found in find_recordings(text)]


def test_a_recording_stands_for_itself(fleet: Path) -> None:
    for text in ("fleet/monday/r1", "files/a.mcap", "files", "fleet/notes.txt"):
        assert named(text) == [text]
    assert named("./files//a.mcap") == ["files/a.mcap"]


def test_what_leads_to_none_is_named_so_that_opening_it_says_why(fleet: Path) -> None:
    for text in ("nowhere", "nowhere/*.mcap", "fleet/empty", "files/*.bag"):
        assert named(text) == [text]


def test_another_folder_stands_for_all_recordings_in_it_by_name(fleet: Path) -> None:
    assert named("fleet") == ["fleet/monday/r1", "fleet/monday/r2", "fleet/tuesday/r1"]
    assert named("fleet/monday/") == ["fleet/monday/r1", "fleet/monday/r2"]


def test_a_pattern_stands_for_what_matches_folders_of_recordings_included(fleet: Path) -> None:
    assert named("files/*.mcap") == ["files/a.mcap", "files/b.mcap"]
    assert named("fleet/*/r1") == ["fleet/monday/r1", "fleet/tuesday/r1"]
    assert named("fleet/**/*.mcap") == ["fleet/monday/r1/r1_0.mcap"]
    assert named("fleet/mon*") == ["fleet/monday/r1", "fleet/monday/r2"]
    assert named("files/*") == ["files/a.mcap", "files/b.mcap", "files/c.txt"]


@pytest.mark.parametrize("text", ["fleet/**", "fleet/**/", "fleet/**/*"])
def test_what_a_pattern_matches_together_with_its_folder_counts_once(text: str, fleet: Path) -> None:
    assert [one for one in named(text) if "notes.txt" not in one and "empty" not in one] == named("fleet")


def test_a_file_beside_folders_hides_no_recording(fleet: Path) -> None:
    (fleet / "fleet/monday/loose.mcap").touch()
    (fleet / "fleet/monday/r2/inner").mkdir()
    (fleet / "fleet/monday/r2/inner/of_r2.mcap").touch()
    assert named("fleet/monday") == ["fleet/monday", "fleet/monday/r1", "fleet/monday/r2"]
    assert named("fleet")[:3] == named("fleet/monday")


@pytest.mark.parametrize(
    ("text", "robots"),
    [
        ("fleet", ["monday", "monday", "tuesday"]),
        ("./fleet/", ["monday", "monday", "tuesday"]),
        ("fleet/*/r1", ["monday", "tuesday"]),
        ("./fleet/*/r1", ["monday", "tuesday"]),
        ("fleet/mon*", ["monday", "monday"]),
        ("fleet/monday/r?", ["", ""]),
        ("fleet/**/*.mcap", ["monday"]),
        ("fleet/monday", ["", ""]),
        ("files/*.mcap", ["", ""]),
        ("files/a.mcap", [""]),
    ],
)
def test_the_robot_is_the_first_folder_that_is_left_open(text: str, robots: list[str], fleet: Path) -> None:
    assert [found.robot for found in find_recordings(text)] == robots


def test_a_name_with_the_characters_of_a_pattern_is_a_name(fleet: Path) -> None:
    (fleet / "run[1]").mkdir()
    assert named("run[1]") == ["run[1]"]


def test_a_circle_of_links_is_not_walked(fleet: Path) -> None:
    (fleet / "fleet" / "again").symlink_to("..")
    (fleet / "fleet" / "newest").symlink_to("tuesday/r1")
    expected = ["fleet/monday/r1", "fleet/monday/r2", "fleet/newest", "fleet/tuesday/r1"]
    assert named("fleet") == expected


def notices_of(text: str) -> list[str]:
    notices: list[str] = []
    find_recordings(text, noticed=notices.append)
    return notices


def test_bags_of_ros_1_are_counted_with_what_converts_them(fleet: Path) -> None:
    assert notices_of("fleet") == []
    (fleet / "fleet/monday/r1/old.bag").touch()
    convert = "convert it: rosbags-convert --src old.bag --dst old"
    assert notices_of("fleet") == [
        f"fleet: 1 ROS 1 bag (fleet/monday/r1/old.bag) is left out; {convert}",
    ]
    for name in ("older", "oldest"):
        (fleet / f"fleet/tuesday/{name}.bag").touch()
    assert notices_of("fleet/*") == [
        f"fleet/*: 3 ROS 1 bags (first fleet/monday/r1/old.bag) are left out; {convert}"
    ]


def test_a_bag_of_ros_1_that_was_converted_or_is_opened_needs_no_word(fleet: Path) -> None:
    (fleet / "fleet/monday/r1.bag").touch()
    (fleet / "fleet/empty/old.bag").touch()
    (fleet / "fleet/tuesday/r3.bag").mkdir()
    assert notices_of("fleet/monday") == notices_of("fleet/empty") == notices_of("fleet/tuesday") == []


@contextmanager
def not_as_root() -> Iterator[None]:
    """Root reads any folder."""
    user = os.geteuid()
    if user == 0:
        os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(user)


def test_a_folder_that_cannot_be_read_is_named(fleet: Path) -> None:
    assert notices_of("fleet") == []
    folder = fleet / "fleet/tuesday"
    folder.chmod(0)
    fleet.chmod(0o755)
    try:
        with not_as_root():
            notices, names = notices_of("fleet"), named("fleet")
    finally:
        folder.chmod(0o755)
    assert notices == ["fleet: 1 folder (fleet/tuesday) cannot be read: Permission denied"]
    assert names == ["fleet/monday/r1", "fleet/monday/r2"]


def pairs(a: str, b: str) -> list[tuple[str, str] | str]:
    return [
        (str(pair.a), str(pair.b)) if isinstance(pair, RecordingPair) else str(pair)
        for pair in pair_recordings(a, b)
    ]


def test_two_recordings_are_a_pair_whatever_they_are_called(fleet: Path) -> None:
    assert pairs("fleet/monday/r1", "files") == [("fleet/monday/r1", "files")]


def test_recordings_are_paired_by_their_names_below_the_folders(fleet: Path) -> None:
    assert pairs("fleet/monday", "fleet/tuesday") == [
        ("fleet/monday/r1", "fleet/tuesday/r1"),
        "fleet/monday/r2: error: fleet/tuesday has no recording r2; "
        "recordings are paired by their names below the folder, or by what the pattern leaves open",
    ]


def test_recordings_are_paired_by_what_the_patterns_leave_open(fleet: Path) -> None:
    for day in ("monday", "tuesday"):
        for end in ("sent", "received"):
            (fleet / day).mkdir(exist_ok=True)
            (fleet / day / f"{end}.mcap").touch()
    assert pairs("*/sent.mcap", "*/received.mcap") == [
        ("monday/sent.mcap", "monday/received.mcap"),
        ("tuesday/sent.mcap", "tuesday/received.mcap"),
    ]


def test_a_point_before_a_pattern_changes_no_pair(fleet: Path) -> None:
    pairs = pair_recordings("./fleet/monday/*", "fleet/./tuesday/*")
    assert pairs[0] == RecordingPair(a=Path("fleet/monday/r1"), b=Path("fleet/tuesday/r1"), key="r1")


def test_one_without_a_partner_on_either_side_is_an_error(fleet: Path) -> None:
    refused = [
        one for one in pair_recordings("fleet/tuesday/*", "fleet/monday/*") if isinstance(one, RecordingError)
    ]
    assert [one.place for one in refused] == ["fleet/monday/r2"]
