# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo fmt``."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest

from smarttestudo.cli.commands import command_parser
from smarttestudo.language.parser import MAX_FILE_BYTES

UGLY = "begin SetFrequency /odom 10 end"
NICE = "begin\n    SetFrequency /odom 10\nend\n"
BROKEN = "begin\n  SetFrequncy /odom 10\nend\n"


def run(*arguments: str | Path) -> int:
    parsed = command_parser().parse_args(["fmt", *map(str, arguments)])
    code: int = parsed.run(parsed)
    return code


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, text in (("ugly", UGLY), ("nice", NICE), ("broken", BROKEN)):
        Path(f"{name}.adirf").write_bytes(text.encode())
    return tmp_path


def test_a_file_is_formatted_in_place(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("ugly.adirf", "nice.adirf") == 0
    assert Path("ugly.adirf").read_text() == NICE
    assert capsys.readouterr() == ("formatted ugly.adirf\n", "")


def test_a_formatted_file_is_not_written(folder: Path) -> None:
    os.utime("nice.adirf", ns=(1, 1))
    before = Path("nice.adirf").stat()
    assert run("nice.adirf") == 0
    after = Path("nice.adirf").stat()
    assert (after.st_mtime_ns, after.st_ino) == (before.st_mtime_ns, before.st_ino)


def test_check_lists_what_would_change_and_writes_nothing(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("--check", "ugly.adirf", "nice.adirf") == 1
    assert capsys.readouterr() == ("ugly.adirf\n", "")
    assert Path("ugly.adirf").read_text() == UGLY
    assert run("--check", "nice.adirf") == 0


def test_a_file_with_errors_is_left_and_explained_and_the_others_are_formatted(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("missing.adirf", "broken.adirf", "ugly.adirf") == 1
    assert Path("broken.adirf").read_text() == BROKEN
    assert Path("ugly.adirf").read_text() == NICE
    out, err = capsys.readouterr()
    assert out == "formatted ugly.adirf\n"
    assert err.splitlines() == [
        "missing.adirf: error: there is no such file; check the path",
        "broken.adirf:2:3: error[expected-statement]: expected a statement "
        "('SetFrequency', 'KeepAtLeast', 'KeepWithin', 'Rule' or 'If') or 'end', found 'SetFrequncy'",
        "    SetFrequncy /odom 10",
        "    ^^^^^^^^^^^",
        "    hint: did you mean 'SetFrequency'?",
    ]


@pytest.mark.parametrize("arguments", [(), ("--check",)])
def test_a_file_that_would_become_too_large_is_left(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...]
) -> None:
    text = "begin SetFrequency /odom 10 end // ".ljust(MAX_FILE_BYTES, "x")
    Path("large.adirf").write_text(text)
    assert run("large.adirf", *arguments) == 1
    assert Path("large.adirf").read_text() == text
    assert capsys.readouterr() == (
        "",
        "large.adirf: error: the rule file would be larger than 4 MB in the house style; "
        "it is left as it is; split it into several\n",
    )


def test_a_folder_stands_for_its_files(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(".") == 1
    assert Path("ugly.adirf").read_text() == NICE


def test_line_ends_stay(folder: Path) -> None:
    Path("ugly.adirf").write_bytes(b"begin\r\nSetFrequency /odom 10 end\r\n")
    assert run("ugly.adirf") == 0
    assert Path("ugly.adirf").read_bytes() == NICE.replace("\n", "\r\n").encode()


def given(text: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have standard input hold ``text``."""
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text), encoding="ascii"))


@pytest.mark.parametrize("text", [UGLY, NICE])
def test_standard_input_is_formatted_to_standard_output(
    text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(text.encode(), monkeypatch)
    assert run("-") == 0
    assert capsys.readouterr() == (NICE, "")


def test_standard_input_with_errors_is_explained_and_nothing_is_written(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(BROKEN.encode(), monkeypatch)
    assert run("-") == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("<stdin>:2:3: error[expected-statement]: ")


def test_check_names_standard_input_among_files_and_writes_nothing(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(UGLY.encode(), monkeypatch)
    assert run("--check", "nice.adirf", "-", "ugly.adirf") == 1
    assert capsys.readouterr() == ("<stdin>\nugly.adirf\n", "")
    given(NICE.encode(), monkeypatch)
    assert run("--check", "-") == 0


def test_a_file_whose_name_is_a_dash_is_named_with_its_folder(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given(b"", monkeypatch)
    Path("-").write_text(UGLY)
    assert run("./-") == 0
    assert Path("-").read_text() == NICE
    assert capsys.readouterr() == ("formatted -\n", "")


@pytest.mark.contract
def test_text_in_any_locale_goes_through_a_pipe_as_it_is(tmp_path: Path) -> None:
    text = "// Über die Brücke → ✓\r\nbegin\r\n    SetFrequency /odom 10\r\nend\r\n"
    done = subprocess.run(
        [sys.executable, "-m", "smarttestudo", "fmt", "-"],
        input=text.encode(),
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
        capture_output=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, text.encode(), b"")
