# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from bags.bag_factory import small_mission, write_bag
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.simulation.demo.demo import run_demo
from smarttestudo.simulation.demo.folder import MARKER, DemoFolderError, DemoRequest, demo_folder


def _make(out: Path, text: str) -> None:
    with demo_folder(out, needed_bytes=0, made={MARKER}, filled={}) as work:
        (work / MARKER).write_text(text)


def test_the_folder_appears_whole_when_everything_is_written(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "demo-out"

    with demo_folder(out, needed_bytes=0, made={MARKER}, filled={}) as work:
        (work / MARKER).write_text("1")
        assert not out.exists()

    assert [path.name for path in out.iterdir()] == [MARKER]
    assert [path.name for path in out.parent.iterdir()] == ["demo-out"]


def test_a_failure_leaves_nothing_and_keeps_the_former_demo(tmp_path: Path) -> None:
    out = tmp_path / "demo-out"
    _make(out, "former")

    def interrupted() -> None:
        with demo_folder(out, needed_bytes=0, made={MARKER}, filled={}) as work:
            (work / MARKER).write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()

    assert (out / MARKER).read_text() == "former"
    assert [path.name for path in tmp_path.iterdir()] == ["demo-out"]


def test_a_former_demo_and_an_empty_folder_are_replaced_and_what_others_put_there_stays(
    tmp_path: Path,
) -> None:
    out = tmp_path / "demo-out"
    out.mkdir()

    _make(out, "first")
    (out / "mine").mkdir()
    (out / "mine" / "notes.txt").write_text("mine")
    _make(out, "second")

    assert {path.name for path in out.iterdir()} == {MARKER, "mine"}
    assert (out / MARKER).read_text() == "second"
    assert (out / "mine" / "notes.txt").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["demo-out"]


def _make_with_bag(out: Path, text: str) -> None:
    with demo_folder(out, needed_bytes=0, made={MARKER, "bag", "old.log"}, filled={}) as work:
        write_bag(work / "bag", small_mission(1))
        (work / MARKER).write_text(text)


@pytest.mark.parametrize("foreign", ["bag/notes.txt", "bag/cut.mcap", "bag/more/notes.txt"])
def test_what_others_put_into_a_recording_of_the_demo_is_named_and_stays(
    foreign: str, tmp_path: Path
) -> None:
    out = tmp_path / "demo-out"
    _make_with_bag(out, "first")
    (out / foreign).parent.mkdir(exist_ok=True)
    (out / foreign).write_text("mine")
    before = sorted(tmp_path.rglob("*"))

    with pytest.raises(DemoFolderError, match=rf"{foreign[:8]}.*move that elsewhere, or name another folder"):
        _make_with_bag(out, "second")

    assert (out / foreign).read_text() == "mine"
    assert (out / MARKER).read_text() == "first"
    assert sorted(tmp_path.rglob("*")) == before


def test_what_a_former_demo_made_goes_and_links_lead_nowhere(tmp_path: Path) -> None:
    out = tmp_path / "demo-out"
    _make_with_bag(out, "first")
    (out / "old.log").write_text("old")
    (tmp_path / "theirs").mkdir()
    (tmp_path / "theirs" / "notes.txt").write_text("mine")
    (out / "link").symlink_to(tmp_path / "theirs")

    _make_with_bag(out, "second")

    assert {path.name for path in out.iterdir()} == {MARKER, "bag", "link"}
    assert (out / "link" / "notes.txt").read_text() == "mine"
    assert {path.name for path in tmp_path.iterdir()} == {"demo-out", "theirs"}

    (out / "link").rename(out / "old.log")
    with pytest.raises(DemoFolderError, match=r"old\.log"):
        _make_with_bag(out, "third")
    assert (tmp_path / "theirs" / "notes.txt").read_text() == "mine"


def test_what_cannot_be_put_in_place_leaves_the_former_demo_as_it_was(tmp_path: Path) -> None:
    out = tmp_path / "demo-out"
    _make_with_bag(out, "first")
    (out / "report").write_text("mine")

    def not_announced() -> None:
        with demo_folder(out, needed_bytes=0, made={MARKER, "bag"}, filled={}) as work:
            write_bag(work / "bag", small_mission(1))
            (work / "report").write_text("the demo's")
            (work / MARKER).write_text("second")

    with pytest.raises(DemoFolderError, match=r"File exists \(.*report\)"):
        not_announced()
    assert (out / MARKER).read_text() == "first"
    assert (out / "report").read_text() == "mine"
    assert len(list((out / "bag").iterdir())) == 2
    assert [path.name for path in tmp_path.iterdir()] == ["demo-out"]


@pytest.mark.parametrize("kind", ["folder", "file"])
def test_what_no_demo_made_is_never_replaced(kind: str, tmp_path: Path) -> None:
    out = tmp_path / "precious"
    if kind == "folder":
        out.mkdir()
        (out / "thesis.tex").touch()
    else:
        out.touch()

    with pytest.raises(DemoFolderError, match=r"was not made by 'testudo demo'.*--out"):
        _make(out, "new")

    assert [path.name for path in tmp_path.iterdir()] == ["precious"]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()

    with pytest.raises(
        DemoFolderError, match=r"file/demo-out: error: cannot be written: File exists \(.*file\)"
    ):
        _make(tmp_path / "file" / "demo-out", "new")


def test_a_disk_that_is_too_small_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    with (
        pytest.raises(DemoFolderError, match=r"needs 10 000 000 000 MB"),
        demo_folder(tmp_path / "out", needed_bytes=10**16, made=(), filled={}),
    ):
        pass

    assert list(tmp_path.iterdir()) == []


def test_a_file_that_cannot_be_written_is_one_clear_error(tmp_path: Path) -> None:
    def fill() -> None:
        with demo_folder(tmp_path / "demo-out", needed_bytes=0, made={MARKER}, filled={}) as work:
            (work / "no-such-folder" / "report.html").write_text("")

    with pytest.raises(
        DemoFolderError, match=r"demo-out: error: cannot be written: No such file.*report\.html"
    ):
        fill()

    assert list(tmp_path.iterdir()) == []


@pytest.mark.full
def test_progress_names_the_folder_that_was_asked_for_and_not_where_it_is_made(tmp_path: Path) -> None:
    labels: list[str] = []

    @contextmanager
    def progress(label: str) -> Iterator[Callable[[float], None]]:
        labels.append(label)
        yield lambda _share: None

    out = tmp_path / "demo-out"
    run_demo(
        DemoRequest(out=out, seconds=3, seed=0, full_images=False, when_slow=WhenSlow.PASS, progress=progress)
    )
    assert [label for label in labels if label.startswith("Reading")] == [
        f"Reading {out / 'baseline'}",
        f"Reading {out / 'adaptive'}",
    ]


def test_a_folder_of_other_files_than_a_recording_is_replaced_if_it_holds_nothing_else(
    tmp_path: Path,
) -> None:
    out = tmp_path / "out"

    def make(text: str) -> None:
        filled = {"tables": {"a.md"}}
        with demo_folder(out, needed_bytes=0, made={MARKER, "tables"}, filled=filled) as work:
            (work / "tables").mkdir()
            (work / "tables" / "a.md").write_text(text)
            (work / MARKER).touch()

    make("first")
    make("second")
    assert (out / "tables" / "a.md").read_text() == "second"

    (out / "tables" / "mine.md").touch()
    with pytest.raises(DemoFolderError, match=r"tables/mine\.md"):
        make("third")
    assert (out / "tables" / "a.md").read_text() == "second"
