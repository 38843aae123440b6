# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Disks, streams and terminals that take no more: one line, and nothing half done is left."""

from __future__ import annotations

import errno
import importlib
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import zstandard

from bags.bag_factory import small_mission, write_bag
from smarttestudo.files.whole_file import OutputFileError, not_written, whole_file
from smarttestudo.incidents.live_incidents import FolderLock
from smarttestudo.loop.decision_log import decision_log
from smarttestudo.loop.input_log import input_log
from smarttestudo.loop.inputs import WakeInput

RULES = """begin
  SetFrequency /odom 5
  Rule "Far" If (CheckValue /odom pose_y > 2) Then SetFrequency /odom 9
end
"""
PROFILE = 'budget_kb_per_s = 100\n[topics."/odom"]\nmessage_kb = 0.7\nsource_hz = 20\n'
TIMEOUT_S = 120
FULL = Path("/dev/full")
REPLAY = ("replay", "sq", "--rules", "a.adirf", "--output", "new")
# Ends, by the signal in its arguments, a replay that has begun to write.
SIGNALLED = """
import os, sys
from smarttestudo.bags.sqlite.writer import SqliteWriter
from smarttestudo.cli.main import main
write = SqliteWriter.write
def write_and_signal(*arguments):
    write(*arguments)
    os.kill(os.getpid(), int(sys.argv[1]))
SqliteWriter.write = write_and_signal
sys.exit(main(sys.argv[2:]))
"""
# What it is asked to import first is where Ctrl-C comes.
INTERRUPTED_IMPORT = """
import os, signal, sys
class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "smarttestudo.cli.check":
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupting())
from smarttestudo.cli.main import main
sys.exit(main(["check", "a.adirf"]))
"""


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("desk")
    write_bag(folder / "sq", small_mission())
    (folder / "a.adirf").write_text(RULES)
    (folder / "p.toml").write_text(PROFILE)
    return folder


@pytest.fixture
def unchanged(desk: Path) -> Iterator[Path]:
    """The folder, in which the test leaves nothing."""
    before = sorted(desk.rglob("*"))
    yield desk
    assert sorted(desk.rglob("*")) == before


def run_testudo(*arguments: str, code: str | None = None, **options: Any) -> subprocess.CompletedProcess[str]:
    start = ("-m", "smarttestudo") if code is None else ("-c", code)
    ran: subprocess.CompletedProcess[str] = subprocess.run(
        # Bytecode that a limit cuts off would break later imports.
        [sys.executable, "-B", *start, *arguments],
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        timeout=TIMEOUT_S,
        **options,
    )
    return ran


def without_space() -> None:
    """No file may have a byte more than 4096, which is how a full disk looks to a program."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


@pytest.mark.parametrize(
    "command",
    [
        ("check", "a.adirf"),
        ("bag", "info", "sq"),
        ("bag", "loss", "sq"),
        ("optimize", "a.adirf", "--profile", "p.toml"),
    ],
)
def test_a_standard_output_that_is_full_or_closed_is_one_line(
    unchanged: Path, command: tuple[str, ...]
) -> None:
    with FULL.open("w") as full:
        ran = run_testudo(*command, cwd=unchanged, stdout=full)
    line = "standard output: error: cannot be written: No space left on device; write to another place\n"
    assert (ran.returncode, ran.stderr) == (1, line)
    ran = run_testudo(*command, cwd=unchanged, preexec_fn=lambda: os.close(1))
    line = "standard output: error: cannot be written: Bad file descriptor; write to another place\n"
    assert (ran.returncode, ran.stderr) == (1, line)


def test_a_command_that_prints_nothing_needs_no_standard_output(desk: Path) -> None:
    (desk / "f.adirf").write_text("begin\nend\n")
    assert run_testudo("fmt", "f.adirf", cwd=desk, preexec_fn=lambda: os.close(1)).returncode == 0
    (desk / "f.adirf").unlink()


def test_errors_that_nobody_can_read_go_nowhere(unchanged: Path) -> None:
    code = "import os, sys; os.execv(sys.executable, [sys.executable, '-m', 'smarttestudo', 'check', 'no'])"
    ran = subprocess.run(
        [sys.executable, "-c", code],
        cwd=unchanged,
        stdout=subprocess.PIPE,
        check=False,
        timeout=TIMEOUT_S,
        preexec_fn=lambda: os.close(2),
    )
    assert (ran.returncode, ran.stdout) == (1, b"")


@pytest.mark.parametrize(
    ("command", "line"),
    [
        (
            ("bag", "report", "sq", "-o", "r.html"),
            "r.html: error: the report cannot be written: File too lar",
        ),
        (("bag", "rates", "sq", "--figures", "."), "rates.png: error: the figure cannot be written: File to"),
        (REPLAY, "new: error: "),
    ],
)
def test_a_full_disk_is_one_line_and_leaves_nothing(
    unchanged: Path, command: tuple[str, ...], line: str
) -> None:
    # Matplotlib says a line of its own where it cannot keep the list of fonts, made once on a machine.
    importlib.import_module("matplotlib.font_manager")
    ran = run_testudo(*command, cwd=unchanged, preexec_fn=without_space, stdout=subprocess.DEVNULL)
    assert ran.returncode == 1
    assert ran.stderr.startswith(line)
    assert ran.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("command", "line"),
    [
        (("profile", "--bag", "sq", "-o", "new.toml"), "new.toml: error: the profile cannot be written: "),
        (
            ("optimize", "a.adirf", "--profile", "p.toml", "-o", "b.adirf"),
            "b.adirf: error: the rule file can",
        ),
        (("fmt", "a.adirf"), "a.adirf: error: the rule file cannot be written: "),
    ],
)
def test_no_empty_file_stays_where_nothing_can_be_written(
    unchanged: Path, command: tuple[str, ...], line: str
) -> None:
    before = (unchanged / "a.adirf").read_text()
    ran = run_testudo(
        *command,
        cwd=unchanged,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0)),
        stdout=subprocess.DEVNULL,
    )
    assert ran.returncode == 1
    assert ran.stderr.startswith(line)
    assert ran.stderr.count("\n") == 1
    assert (unchanged / "a.adirf").read_text() == before


def test_decisions_that_find_no_space_end_the_replay_in_one_line(unchanged: Path) -> None:
    ran = run_testudo(*REPLAY, "--decisions", "/dev/full", cwd=unchanged, stdout=subprocess.DEVNULL)
    assert (ran.returncode, ran.stderr) == (
        1,
        "/dev/full: error: the decision log cannot be written: No space left on device; "
        "free some space or write to another disk\n",
    )


def test_a_packed_recording_that_finds_no_space_says_where(desk: Path, tmp_path: Path) -> None:
    packed = tmp_path / "sq.db3.zstd"
    packed.write_bytes(zstandard.ZstdCompressor().compress((desk / "sq" / "sq.db3").read_bytes()))
    (tmp_path / "full").mkdir()
    ran = run_testudo(
        *("bag", "info", packed.name),
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        preexec_fn=without_space,
        env={**os.environ, "TMPDIR": str(tmp_path / "full")},
    )
    assert (ran.returncode, ran.stderr) == (
        1,
        f"sq.db3.zstd: error: it cannot be decompressed into {tmp_path / 'full'}: File too large; "
        "free some space there, or set TMPDIR to a folder that has more\n",
    )


def test_a_full_disk_is_told_from_a_bad_name() -> None:
    with (
        pytest.raises(OutputFileError, match="No space left on device; free some space or write to another"),
        whole_file(FULL, "the report") as write,
    ):
        write("text")


def test_a_file_in_place_of_a_folder_is_told_as_that(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    cause = "a file is there in place of a folder; name another place"
    with pytest.raises(OutputFileError, match=f"file: error: the folder of --incidents .* written: {cause}"):
        FolderLock(tmp_path / "file", "--incidents")
    with (
        pytest.raises(OutputFileError, match=f"the decision log cannot be written: {cause}"),
        decision_log(tmp_path / "file" / "log.jsonl"),
    ):
        pass


def test_a_place_that_is_forbidden_names_permissions() -> None:
    error = PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    assert str(not_written(Path("rules.adirf"), "the rule file", error)) == (
        "rules.adirf: error: the rule file cannot be written: Permission denied; "
        "check its permissions and those of its folder, or name another place"
    )


def test_a_log_of_inputs_that_could_not_be_begun_does_not_stop_the_next(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), input_log(tmp_path / "inputs"):
        raise KeyboardInterrupt
    with input_log(tmp_path / "inputs") as note:
        note(WakeInput(stamp_ns=1))


def test_a_device_is_written_to_and_stays_a_device() -> None:
    with whole_file(Path(os.devnull), "the report") as write:
        write("text")
    assert Path(os.devnull).is_char_device()


def test_a_file_of_the_longest_name_is_written(tmp_path: Path) -> None:
    path = tmp_path / ("n" * 255)
    with whole_file(path, "the report") as write:
        write("text")
    assert path.read_text() == "text"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_leaves_no_unfinished_recording(unchanged: Path, number: signal.Signals) -> None:
    ran = run_testudo(str(int(number)), *REPLAY, code=SIGNALLED, cwd=unchanged, stdout=subprocess.DEVNULL)
    word = "interrupted" if number == signal.SIGINT else "terminated"
    assert (ran.returncode, ran.stderr) == (128 + number, f"{word}\n")


def test_ctrl_c_while_modules_are_imported_is_one_line(unchanged: Path) -> None:
    ran = run_testudo(code=INTERRUPTED_IMPORT, cwd=unchanged, stdout=subprocess.DEVNULL)
    assert (ran.returncode, ran.stderr) == (130, "interrupted\n")
