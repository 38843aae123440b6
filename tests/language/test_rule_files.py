# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Reading, finding and replacing rule files on disk."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from smarttestudo.domain.errors import RuleFileError
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.rules.rule_files import find_rule_files, read_rule_text, write_rule_text
from smarttestudo.rules.rule_sets import load_rules


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_utf_8_is_read_with_and_without_a_byte_order_mark(tmp_path: Path, mark: bytes) -> None:
    path = tmp_path / "rules.adirf"
    path.write_bytes(mark + "begin // é\r\nend".encode())
    assert read_rule_text(path) == "begin // é\r\nend"


@pytest.mark.parametrize(
    ("data", "complaint"),
    [
        ("begin end".encode("utf-16"), ": error: the rule file is in UTF-16; save it as UTF-8"),
        (
            "begin end".encode("utf-16-le"),
            ": error: the rule file holds zero bytes, as UTF-16 and binary files do; save it as UTF-8",
        ),
        (
            "begin\n // zone: caf\xe9".encode("latin-1"),
            ":2:14: error: the byte 0xE9 is not UTF-8; save it as UTF-8",
        ),
        (b"\xef\xbb\xbf\xff", ":1:1: error: the byte 0xFF is not UTF-8; save it as UTF-8"),
        (
            b"/" * 4_000_001,
            ": error: the rule file is larger than 4 MB; split it into several; is it a rule file?",
        ),
    ],
)
def test_what_is_no_rule_file_is_refused_in_one_line(tmp_path: Path, data: bytes, complaint: str) -> None:
    path = tmp_path / "rules.adirf"
    path.write_bytes(data)
    with pytest.raises(RuleFileError) as refused:
        read_rule_text(path)
    assert str(refused.value) == f"{path}{complaint}"


def test_a_huge_file_is_refused_without_reading_it(tmp_path: Path) -> None:
    path = tmp_path / "rules.adirf"
    path.touch()
    os.truncate(path, 10**12)
    with pytest.raises(RuleFileError, match="larger than 4 MB"):
        read_rule_text(path)


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RuleFileError, match=r"missing\.adirf: error: there is no such file; check the path"):
        read_rule_text(tmp_path / "missing.adirf")
    with pytest.raises(RuleFileError, match="error: this is a folder; give a rule file"):
        read_rule_text(tmp_path)


def test_a_folder_stands_for_its_rule_files_in_order(tmp_path: Path) -> None:
    for name in ("b.adirf", "a.adirf", "notes.txt"):
        (tmp_path / name).touch()
    (tmp_path / "c.adirf").mkdir()
    other = tmp_path / "notes.txt"
    assert find_rule_files([other, tmp_path]) == [other, tmp_path / "a.adirf", tmp_path / "b.adirf"]


def test_a_file_given_twice_counts_once(tmp_path: Path) -> None:
    path = tmp_path / "a.adirf"
    path.touch()
    assert find_rule_files([path, tmp_path, tmp_path / "." / "a.adirf"]) == [path]


def test_nothing_found_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(RuleFileError, match="the folder holds no rule files; give a file, or a folder with"):
        find_rule_files([tmp_path])
    with pytest.raises(RuleFileError, match="there is no such file"):
        find_rule_files([tmp_path / "missing"])


def test_replacing_a_file_keeps_its_permissions_and_links(tmp_path: Path) -> None:
    path, link = tmp_path / "rules.adirf", tmp_path / "link.adirf"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    write_rule_text(link, "new é\r\n")
    assert link.is_symlink()
    assert path.read_bytes() == "new é\r\n".encode()
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert sorted(one.name for one in tmp_path.iterdir()) == ["link.adirf", "rules.adirf"]


def test_a_file_that_cannot_be_replaced_stays(tmp_path: Path) -> None:
    with pytest.raises(OutputFileError, match="the rule file cannot be written: No such file or directory"):
        write_rule_text(tmp_path / "missing" / "rules.adirf", "new")
    assert list(tmp_path.iterdir()) == []


def test_a_name_that_is_not_utf_8_is_told_in_utf_8(tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b"r\xe9gles.adirf")
    path.write_text("begin SetFrequency /imu 10 end", encoding="utf-8")
    assert load_rules([path]).in_force.paths == (f"{tmp_path}/r?gles.adirf",)
