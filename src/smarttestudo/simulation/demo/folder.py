# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Request for a demo, its rules, and the folder that it leaves.

The folder is whole or not there, and comes in place of nothing but what a former demo made.
"""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from smarttestudo.bags.metadata import read_metadata
from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.domain.errors import RecordingError, RuleFileError, TestudoError
from smarttestudo.domain.robot import Robot
from smarttestudo.domain.units import grouped
from smarttestudo.files.removal import remove, temporary_folder
from smarttestudo.files.whole_file import PARTIAL_SUFFIX
from smarttestudo.language.rule_set import RuleSet
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.report.bag_report import Progress
from smarttestudo.rules.rule_files import read_rule_text
from smarttestudo.rules.rule_sets import check_texts

BASELINE = "baseline"
ADAPTIVE = "adaptive"
DECISIONS = "decisions.jsonl"
REPORT = "report.html"
ACCURACY = "accuracy.json"
THESIS = "thesis"
LOGS = ("runtime.log", "robot.log")
MARKER = "demo.json"
RULES = "warehouse.adirf"
WITHIN = "warehouse_within.adirf"
PREDICTED = "warehouse_predicted.adirf"


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoRequest:
    """How long a mission, with which noise, and into which folder.

    ``full_images`` asks for whole camera frames, about 0.2 GB each second, instead of small ones. With a
    ``robot``, the node that records, the mission takes place in real time on a real ROS graph, with
    ``physics`` by a robot that has masses and forces. ``mission`` is the file of a tour; without one the
    robot drives the patrol of the thesis. ``with_thesis`` asks for the tables and figures of the thesis, too.
    """

    out: Path
    seconds: float
    seed: int
    full_images: bool
    when_slow: WhenSlow
    progress: Progress
    robot: Robot | None = None
    mission: Path | None = None
    physics: bool = False
    with_thesis: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoRules:
    """Rules of the demo, called ``name``; ``notice`` says so where they are not the demo's own."""

    name: str
    text: str
    rule_set: RuleSet
    notice: str | None


def put_rules(folder: Path, former: Path, name: str = RULES) -> DemoRules:
    """Put rules into a new demo's ``folder``: those of that ``name`` in ``former`` if the user edited them.

    Raises:
        RuleFileError: the edited rules cannot be read or have an error.
    """
    own = files("smarttestudo.simulation").joinpath(name).read_bytes()
    kept, path = former / name, folder / name
    are_edited = kept.is_file() and kept.read_bytes() != own
    if are_edited:
        shutil.copy(kept, path)
    else:
        path.write_bytes(own)
    text = read_rule_text(path)
    loaded = check_texts({name: text})
    for error in loaded.errors:
        place = f"{kept}:{error.span.line}:{error.span.column}"
        remedy = "fix it, or move the file away to use the demo's own rules"
        raise RuleFileError(error.message, place=place, remedy=remedy)
    notice = f"{kept} was edited: kept and used; without it the demo takes its own rules"
    return DemoRules(name=name, text=text, rule_set=loaded.rule_set, notice=notice if are_edited else None)


class DemoFolderError(TestudoError):
    """The demo's folder cannot be made or may not be replaced."""


@contextmanager
def demo_folder(
    out: Path, *, needed_bytes: int, made: Collection[str], filled: Mapping[str, Collection[str]]
) -> Iterator[Path]:
    """A new folder next to ``out`` that takes its place when the block ends well, and is removed when not.

    The block must write ``MARKER``, by which a later demo knows that it may replace what is in ``out`` under
    the names in ``made``. Whatever else lies there stays where it is. ``filled`` has what may lie in those
    folders among them that are no recordings.

    Raises:
        DemoFolderError: ``out`` is something else than a former demo's folder, one of the folders that a
            demo made there holds something else, ``out`` cannot be written, or the disk has less than
            ``needed_bytes`` left.
    """
    out = Path(os.path.realpath(out))
    with ExitStack() as opened:
        try:
            _refuse_foreign(out, made, filled)
            out.parent.mkdir(parents=True, exist_ok=True)
            _refuse_small_disk(out.parent, needed_bytes)
            workshop = opened.enter_context(
                temporary_folder(out.parent, prefix=f".{out.name}-", suffix=PARTIAL_SUFFIX)
            )
            # A temporary folder is for the user alone; what the demo leaves is as open as its other files.
            work = workshop / out.name
            work.mkdir()
            yield work
            _refuse_foreign(out, made, filled)
            _put(out, work, made)
        except OSError as error:
            raise _not_written(out, error) from error


def _refuse_foreign(out: Path, made: Collection[str], filled: Mapping[str, Collection[str]]) -> None:
    if not os.path.lexists(out) or (out.is_dir() and not any(out.iterdir())):
        return
    if not (out / MARKER).is_file():
        raise DemoFolderError(
            "exists and was not made by 'testudo demo'",
            place=str(out),
            remedy="name another folder with --out",
        )
    foreign = next((file for name in sorted(made) for file in _foreign(out / name, filled.get(name))), None)
    if foreign is not None:
        raise DemoFolderError(
            f"holds what was not made by 'testudo demo': {foreign.relative_to(out)}",
            place=str(out),
            remedy="move that elsewhere, or name another folder with --out",
        )


def _foreign(made: Path, names: Collection[str] | None) -> Iterator[Path]:
    """Things that no demo makes: anything but a file, or a folder with ``names`` or a recording's files."""
    if made.is_symlink():
        yield made
    elif made.is_dir():
        files = _recording_files(made) if names is None else names
        yield from (file for file in sorted(made.iterdir()) if file.is_symlink() or file.name not in files)


def _recording_files(folder: Path) -> Collection[str]:
    try:
        return {METADATA_NAME, *read_metadata(folder).file_names}
    except RecordingError:
        return {METADATA_NAME}


def _refuse_small_disk(parent: Path, needed_bytes: int) -> None:
    free_bytes = shutil.disk_usage(parent).free
    if free_bytes < needed_bytes:
        needed, free = grouped(needed_bytes / 1e6), grouped(free_bytes / 1e6)
        raise DemoFolderError(
            f"the demo needs {needed} MB and the disk has {free} MB left",
            place=str(parent),
            remedy="take fewer --seconds, another --out, or leave out --full-images",
        )


def _put(out: Path, work: Path, made: Collection[str]) -> None:
    """Have all of ``work`` in ``out`` in place of what is ``made`` there, or leave ``out`` as it was."""
    if not os.path.lexists(out):
        work.rename(out)
        return
    former = Path(tempfile.mkdtemp(prefix=f".{out.name}-", suffix=".former", dir=out.parent))
    # With the marker last, a later demo may replace what a killed one leaves.
    names = sorted({*made, *(one.name for one in work.iterdir())}, key=lambda name: (name == MARKER, name))
    moves = [
        (folder / name, target / name)
        for name in names
        for folder, target in ((out, former), (work, out))
        if folder == work or name in made
    ]
    moved: list[tuple[Path, Path]] = []
    try:
        for source, target in moves:
            if os.path.lexists(source):
                _move(source, target)
                moved.append((source, target))
    except BaseException:
        for source, target in reversed(moved):
            _move(target, source)
        remove(former, (), with_folder=True)
        raise
    # What cannot be removed is hidden beside it.
    with suppress(OSError, TestudoError):
        for one in former.iterdir():
            if one.is_dir():
                remove(one, [file.name for file in one.iterdir()], with_folder=True)
        remove(former, made, with_folder=True)


def _move(source: Path, target: Path) -> None:
    if os.path.lexists(target):
        raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(target))
    source.rename(target)


def _not_written(out: Path, error: OSError) -> DemoFolderError:
    culprit = "" if error.filename in (None, str(out)) else f" ({error.filename})"
    return DemoFolderError(
        f"cannot be written: {error.strerror or error}{culprit}",
        place=str(out),
        remedy="name another folder with --out",
    )
