# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is deleted is an incident and nothing else, in whatever folder, and wherever links lead."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from incidents.test_store import NAME, RECORD
from smarttestudo.cli.main import main
from smarttestudo.domain.incident import incident_text
from smarttestudo.files.removal import ForeignFilesError, remove, temporary_folder
from smarttestudo.incidents.store import make_room

Trees = Callable[[Path], list[tuple[str, str]]]
"""Makes a folder of somebody; what may be named as DIR and NAME there."""


def write(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(name)


def add_incident(folder: Path, name: str = NAME) -> Path:
    path = folder / name
    path.mkdir(parents=True)
    (path / "incident.json").write_text(incident_text(RECORD))
    write(path, "metadata.yaml", f"{NAME}_0.mcap", f"{NAME}_1.mcap", "read")
    return path


def root(folder: Path) -> list[tuple[str, str]]:
    write(folder, "etc/passwd", "etc/ssh/key", "usr/bin/sh", "home/ada/thesis.tex", "incident.json")
    (folder / "tmp").mkdir()
    (folder / "bin").symlink_to("usr/bin")
    return [(".", name) for name in ("etc", "usr", "home", "tmp", "bin", "..", ".", str(folder))]


def home(folder: Path) -> list[tuple[str, str]]:
    write(
        folder,
        ".bashrc",
        "Documents/letter.txt",
        "work/incident.json",
        "work/report.odt",
        "empty/incident.json",
    )
    (folder / "usb").symlink_to(folder.parent)
    (folder / NAME).symlink_to(folder / "work")
    names = ("Documents", "work", "empty", "usb", NAME, "usb/other", "Documents/..", str(folder / "work"))
    return [(".", name) for name in names] + [("usb", folder.name), ("Documents", "../work")]


def source_tree(folder: Path) -> list[tuple[str, str]]:
    write(
        folder, "src/main.py", "src/incident.json", ".git/HEAD", "tests/incident.json", "build/metadata.yaml"
    )
    (folder / "src" / "incident.json").write_text(incident_text(RECORD))
    (folder / "tests" / "incident.json").write_text(incident_text(replace(RECORD, name="other")))
    write(folder, f"tests/{NAME}_0.mcap")
    return [(".", name) for name in ("src", ".git", "tests", "build")]


def robots(folder: Path) -> list[tuple[str, str]]:
    add_incident(folder / "incidents" / "ada")
    add_incident(folder / "incidents" / "bob")
    write(folder / "incidents", "ada/notes.txt", f"bob/{NAME}/mine.mcap", f"bob/{NAME}/more/notes.txt")
    linked = add_incident(folder / "incidents", f"{NAME}-2")
    (linked / f"{NAME}_2.mcap").symlink_to(folder / "incidents" / "ada" / NAME / f"{NAME}_0.mcap")
    (linked / f"{NAME}_3.mcap").mkdir()
    return [
        ("incidents", "ada"),
        ("incidents", "bob"),
        (".", "incidents"),
        ("incidents/bob", NAME),
        ("incidents", f"{NAME}-2"),
        ("incidents", f"ada/{NAME}"),
        (f"incidents/ada/{NAME}", "read"),
    ]


def all_of(folder: Path) -> dict[str, object]:
    """Every file, folder and link below it, with what it holds."""
    return {
        str(path.relative_to(folder)): str(path.readlink())
        if path.is_symlink()
        else path.read_bytes()
        if path.is_file()
        else None
        for path in folder.rglob("*")
    }


@pytest.mark.parametrize("tree", [root, home, source_tree, robots])
def test_nothing_is_deleted_that_is_no_incident(
    tmp_path: Path, tree: Trees, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "outside" / "inside"
    folder.mkdir(parents=True)
    write(folder.parent, "other/file")
    named = tree(folder)
    before = all_of(tmp_path)
    monkeypatch.chdir(folder)
    for place, name in named:
        for start in (place, str(folder / place)):
            assert main(["incidents", "delete", start, name]) == 1, (start, name)
            (line,) = capsys.readouterr().err.splitlines()
            assert ": error: " in line
            assert "; " in line, "what helps"
            assert all_of(tmp_path) == before, (start, name)


@pytest.mark.parametrize(
    "other", ["notes.txt", "mine.mcap", f"{NAME}_0.mcap.bak", "20200101T000000000Z-x_0.mcap"]
)
def test_the_other_file_in_the_folder_is_named(
    tmp_path: Path, other: str, capsys: pytest.CaptureFixture[str]
) -> None:
    write(add_incident(tmp_path), other)
    before = all_of(tmp_path)
    assert main(["incidents", "delete", str(tmp_path), NAME]) == 1
    assert f"error: holds something else, too: {other}; move that elsewhere first" in capsys.readouterr().err
    assert all_of(tmp_path) == before


def test_an_incident_is_deleted_whatever_its_folder_is_called_now(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in (NAME, f"{NAME}-2", "renamed"):
        write(
            add_incident(tmp_path / "incidents", name), f"{NAME}-3_0.mcap", ".metadata.yaml-abc_1234.partial"
        )
    (tmp_path / "link").symlink_to(tmp_path / "incidents")
    for name in (NAME, f"{NAME}-2", "renamed"):
        assert main(["incidents", "delete", str(tmp_path / "link"), name]) == 0
        assert capsys.readouterr().out == f"deleted {name}\n"
    assert list((tmp_path / "incidents").iterdir()) == []


def test_one_whose_record_was_cut_is_deleted_where_all_else_says_that_it_is_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in (NAME, "renamed"):
        (add_incident(tmp_path, name) / "incident.json").write_text("{")
    assert main(["incidents", "delete", str(tmp_path), NAME]) == 0
    assert main(["incidents", "delete", str(tmp_path), "renamed"]) == 1
    assert "does not hold the record of an incident; look at what the folder is" in capsys.readouterr().err
    assert [one.name for one in tmp_path.iterdir()] == ["renamed"]


def test_room_is_made_of_incidents_only(tmp_path: Path) -> None:
    for tree in (root, home, source_tree, robots):
        (tmp_path / tree.__name__).mkdir()
        tree(tmp_path / tree.__name__)
    noted = add_incident(tmp_path, f"{NAME}-5")
    write(noted, "notes.txt")
    before = all_of(tmp_path)
    oldest = add_incident(tmp_path, f"{NAME}-4")
    newest = add_incident(tmp_path, f"{NAME}-6")
    kept = all_of(newest)
    gone = {one.name: one.problem for one in make_room(tmp_path, 0)}
    assert [name for name, problem in gone.items() if problem is None] == [oldest.name]
    assert "holds something else, too: notes.txt" in str(gone.pop(noted.name))
    assert list(gone) == [oldest.name]
    assert all_of(newest) == kept
    left = all_of(tmp_path)
    assert {name: left[name] for name in left if not name.startswith(newest.name)} == before


def test_what_is_already_gone_is_no_error_and_what_is_no_file_stays(tmp_path: Path) -> None:
    write(tmp_path, "mine", "folder/file", "theirs")
    (tmp_path / "link").symlink_to(tmp_path / "theirs")
    before = all_of(tmp_path)
    for name in ("folder", "link", "..", "", ".", "folder/file", f"../{tmp_path.name}/theirs"):
        with pytest.raises(ForeignFilesError):
            remove(tmp_path, ["mine", name])
    for place in (tmp_path / "folder" / "..", tmp_path / "folder", tmp_path / "link"):
        with pytest.raises((ForeignFilesError, OSError)):
            remove(place, (), with_folder=True)
    assert all_of(tmp_path) == before
    remove(tmp_path, ["mine", "never there"])
    assert not (tmp_path / "mine").exists()


def test_a_temporary_folder_goes_with_its_links_and_not_with_what_they_lead_to(tmp_path: Path) -> None:
    write(tmp_path, "theirs/file")
    with temporary_folder(tmp_path) as folder:
        write(folder, "deep/file")
        (folder / "link").symlink_to(tmp_path / "theirs")
        os.link(tmp_path / "theirs" / "file", folder / "hard")
    assert all_of(tmp_path) == {"theirs": None, "theirs/file": b"theirs/file"}
