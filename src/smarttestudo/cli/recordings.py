# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Commands over recordings: which are named, who works on them, and what is said of each."""

from __future__ import annotations

import argparse
import os
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar, cast

from smarttestudo.bags.remote_path import RemotePath, is_remote
from smarttestudo.cli.arguments import own_name
from smarttestudo.cli.bag_options import CsvPrinter, print_json, print_notice, print_notices
from smarttestudo.cli.output import Progress, progress, silent, write_line, write_lines
from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.record import to_json
from smarttestudo.domain.units import counted
from smarttestudo.files.outputs import require_separate

if TYPE_CHECKING:
    from smarttestudo.bags.many.parquet import ParquetFolder
    from smarttestudo.bags.many.workers import Workers

EXIT_ERROR = 1
_CLUSTER_TIMEOUT_S = 10.0
_PLACES = ("bag", "a", "b")
"""Arguments that are a recording."""


class Measured(Protocol):
    """The result for one recording, or a pair."""

    @property
    def notices(self) -> Sequence[str]:
        """Losses and oddities, a line each."""

    def rows(self) -> Iterator[dict[str, object]]:
        """The rows of ``--csv``."""


Result = TypeVar("Result", bound=Measured)


class RecordingCommand(ABC, Generic[Result]):
    """A command over recordings, one after the other."""

    table: str
    """The table that ``--parquet`` adds to, by the name of its folder."""
    is_named_by_text = False
    """Whether ``print_text`` says which recording it is about."""
    prints_each = True
    """Whether ``print_text`` prints something, so that an empty line parts it from the next."""

    @staticmethod
    @abstractmethod
    def measure(arguments: argparse.Namespace, progress: Progress) -> Result:
        """Measure the recording in ``arguments``, perhaps in another process."""

    @abstractmethod
    def print_text(self, result: Result) -> None:
        """Print the result for people."""

    def notices(self, result: Result) -> Iterable[str]:
        """Losses and oddities, a line each."""
        return result.notices

    def shown(self, result: Result) -> Result:
        """The part of it that is asked for."""
        return result

    def rows(self, result: Result) -> Iterable[Mapping[str, object]]:
        """Rows that ``--parquet`` adds."""
        return result.rows()

    @abstractmethod
    def columns(self) -> Mapping[str, Any]:
        """The types of the columns of ``rows``."""

    def finish(self, arguments: argparse.Namespace) -> None:
        """Do what follows once a recording was printed."""

    def failed(self, line: str) -> None:
        """Take the ``line`` that was printed of a recording that could not be read."""

    def sum(self) -> str:
        """The sum of all recordings in words."""
        return ""


AskedOne = Mapping[str, Path | str | None]
"""Arguments that stand for one recording or a pair in those of the command; ``key`` is as of one found."""
Asked = AskedOne | TestudoError
"""The same, or why there are none."""


def recordings_asked(arguments: argparse.Namespace) -> list[AskedOne]:
    """The recordings that the command line names, in their order."""
    from smarttestudo.bags.many.recordings import find_recordings  # noqa: PLC0415  needs packages a robot lacks

    return [
        {"bag": found.path, "key": found.key}
        for text in arguments.bags
        for found in find_recordings(text, timeout_s=arguments.timeout, noticed=print_notice)
    ]


def pairs_asked(arguments: argparse.Namespace) -> list[Asked]:
    """Pairs of the recordings that A and B name."""
    from smarttestudo.bags.many.recordings import find_recordings, pair_recordings  # noqa: PLC0415  as above

    a, b, timeout_s = arguments.a, arguments.b, arguments.timeout
    if b is None:
        found = find_recordings(a, timeout_s=timeout_s, noticed=print_notice)
        return [{"a": one.path, "b": None, "key": one.key, "robot": one.robot} for one in found]
    return [
        one if isinstance(one, TestudoError) else {"a": one.a, "b": one.b, "key": one.key, "robot": one.robot}
        for one in pair_recordings(a, b, timeout_s=timeout_s, noticed=print_notice)
    ]


def recordings_in(one: Mapping[str, object]) -> dict[str, Path]:
    """The recordings among arguments, by the argument's name."""
    return {
        name: cast("Path", path) for name in _PLACES if isinstance(path := one.get(name), Path | RemotePath)
    }


def outputs_of_each(there: Sequence[AskedOne], folder: Path) -> Iterator[Path]:
    """Outputs in ``folder``: each is called as its recording, so that they can be paired.

    Raises ``UsageError`` for two of one name, and for one that would be elsewhere.
    """
    outputs: set[Path] = set()
    for one in there:
        (first, *_) = recordings_in(one).values()
        # The key is an absolute path where a wildcard of a pattern stands for nothing.
        output = folder / str(one["key"] or name_of(first)).lstrip("/")
        if ".." in output.relative_to(folder).parts:
            cause = f"the output of {first} would be {output}, which may be outside of {folder}"
            raise UsageError(cause, remedy="name recordings without .. in the path")
        if output in outputs:
            cause = f"the output of {first} would be {output}, as that of another recording"
            raise UsageError(cause, remedy="name the recordings of one folder, then those of the next")
        outputs.add(output)
        yield output


def name_of(recording: Path) -> str:
    """Own name of the recording at a path or a URL."""
    return recording.name if is_remote(recording) else own_name(recording)


def each_recording(
    arguments: argparse.Namespace, asked: Sequence[Asked], command: RecordingCommand[Result]
) -> int:
    """Show what ``command`` says of each of ``asked``, in order; 1 if one could not be read.

    The error of an only one is raised. Of several each has a line, and costs no other.
    """
    output = _Output(command, _parquet_folder(arguments, asked), is_only=len(asked) == 1)
    if len(asked) == 1:
        (only,) = asked
        if isinstance(only, TestudoError):
            raise only
        alone = _with(arguments, only)
        output.show(alone, command.measure(alone, progress))
        return 0
    failed = 0
    there = [one for one in asked if not isinstance(one, TestudoError)]
    with _workers(arguments, there) as workers:
        with closing(_outcomes(workers, arguments, asked, command)) as outcomes:
            for one, outcome in outcomes:
                error = outcome if isinstance(outcome, TestudoError) else output.failure(one, outcome)
                if error is not None:
                    failed += 1
                    command.failed(_print_error(one, error))
        print_notices(workers.notices)
        if workers.failure is not None:
            _print_error(arguments, workers.failure)
    if _is_text(arguments) and command.prints_each:
        failures = f", {failed} with an error" if failed else ""
        sums = [f"{counted(len(asked), 'recording')}{failures}", command.sum()]
        write_lines(["", ": ".join(filter(None, sums))])
    return EXIT_ERROR if failed or workers.failure else 0


def _parquet_folder(arguments: argparse.Namespace, asked: Sequence[Asked]) -> ParquetFolder | None:
    """The folder of ``--parquet``, which must not be in a recording."""
    if arguments.parquet is None:
        return None
    from smarttestudo.bags.many.parquet import ParquetFolder  # noqa: PLC0415  most have no extra fleet

    found = [one for one in asked if not isinstance(one, TestudoError)]
    require_separate(
        {"--parquet": arguments.parquet}, [path for one in found for path in recordings_in(one).values()]
    )
    return ParquetFolder(arguments.parquet)


def _with(arguments: argparse.Namespace, one: Mapping[str, object]) -> argparse.Namespace:
    return argparse.Namespace(**{**vars(arguments), **one})


def _outcomes(
    workers: Workers, arguments: argparse.Namespace, asked: Sequence[Asked], command: RecordingCommand[Result]
) -> Generator[tuple[argparse.Namespace, Result | TestudoError]]:
    """The arguments of each recording with what came of it, in order."""
    there = [one for one in asked if not isinstance(one, TestudoError)]
    label = f"Reading {counted(len(asked), 'recording')}"
    task: Callable[[Mapping[str, Path | str | None]], Result] = partial(
        _measure_one, command.measure, _from_the_root(arguments)
    )
    with closing(workers.map(task, there)) as results:
        for number, one in enumerate(asked):
            if isinstance(one, TestudoError):
                yield arguments, one
                continue
            # What is printed of one must not meet the bar.
            with progress(label) as report:
                report(number / len(asked))
                outcome = next(results)
            yield _with(arguments, one), outcome


def _from_the_root(arguments: argparse.Namespace) -> argparse.Namespace:
    """``arguments`` with paths that mean the same in any folder, where a cluster works on them."""
    if arguments.dask is None:
        return arguments
    return argparse.Namespace(**{name: _absolute(value) for name, value in vars(arguments).items()})


def _absolute(value: object) -> object:
    if isinstance(value, list):
        return [_absolute(one) for one in value]
    return value.absolute() if isinstance(value, Path) else value


def _measure_one(
    measure: Callable[[argparse.Namespace, Progress], Result],
    arguments: argparse.Namespace,
    one: Mapping[str, Path | str | None],
) -> Result:
    return measure(_with(arguments, one), silent)


@contextmanager
def _workers(arguments: argparse.Namespace, there: Sequence[Mapping[str, object]]) -> Iterator[Workers]:
    """The workers that the options ask for."""
    from smarttestudo.bags.many.workers import Workers  # noqa: PLC0415  as above

    # A process takes longer to begin than a short recording.
    usual = min(len(os.sched_getaffinity(0)), len(there) // 2)
    processes = max(1, min(arguments.workers or usual, len(there)))
    if arguments.dask is None:
        yield Workers(processes)
        return
    for one in there:
        for path in recordings_in(one).values():
            if not path.is_absolute():
                cause = f"{path} is another place for each worker"
                raise UsageError(cause, place="--dask", remedy="name recordings from the root, or by a URL")
    from smarttestudo.bags.many.dask_cluster import open_cluster  # noqa: PLC0415  as above

    with open_cluster(arguments.dask, timeout_s=_CLUSTER_TIMEOUT_S) as cluster:
        yield Workers(processes, cluster)


def _print_error(one: argparse.Namespace, error: TestudoError) -> str:
    """Print a line after what was printed, and give it."""
    line = _with_name(one, str(error))
    sys.stdout.flush()
    write_line(line, sys.stderr)
    return line


def _with_name(one: argparse.Namespace, line: str) -> str:
    """``line``, after the name of the recording that it is about where it does not begin with it."""
    names = [str(path) for path in recordings_in(vars(one)).values()]
    return line if not names or line.startswith(tuple(names)) else f"{', '.join(names)}: {line}"


def _is_text(arguments: argparse.Namespace) -> bool:
    """Whether people read what is printed."""
    return not arguments.json and not getattr(arguments, "csv", False)


@dataclass(slots=True)
class _Output(Generic[Result]):
    """Prints each recording as a line of JSON, as rows of one CSV, or as text with empty lines between."""

    command: RecordingCommand[Result]
    parquet: ParquetFolder | None
    is_only: bool
    is_first: bool = True
    csv: CsvPrinter = field(default_factory=CsvPrinter)

    def show(self, one: argparse.Namespace, result: Result) -> None:
        """Print one result in the form that is asked for, and its notices."""
        result = self.command.shown(result)
        if _is_text(one):
            self._print_heading(one)
            self.command.print_text(result)
        elif one.json:
            print_json(self._named(one, to_json(result)))
        else:
            self.csv.print_rows(self._named(one, row) for row in result.rows())
        print_notices(self._noted(one, notice) for notice in self.command.notices(result))
        if self.parquet is not None:
            names = {name: str(path) for name, path in recordings_in(vars(one)).items()}
            rows = ({**names, **row} for row in self.command.rows(result))
            columns = {**dict.fromkeys(names, str), **self.command.columns()}
            self.parquet.add(self.command.table, columns, rows)
        self.command.finish(one)

    def _noted(self, one: argparse.Namespace, notice: str) -> str:
        return notice if self.is_only else _with_name(one, notice)

    def failure(self, one: argparse.Namespace, result: Result) -> TestudoError | None:
        """Print one result; an error that this ends with is returned."""
        try:
            self.show(one, result)
        except TestudoError as error:
            return error
        return None

    def _named(self, one: argparse.Namespace, value: Mapping[str, object]) -> Mapping[str, object]:
        """``value``, of several recordings with the name of its own."""
        if self.is_only:
            return value
        return {**{name: str(path) for name, path in recordings_in(vars(one)).items()}, **value}

    def _print_heading(self, one: argparse.Namespace) -> None:
        if self.is_only or not self.command.prints_each:
            return
        if not self.is_first:
            write_line()
        self.is_first = False
        if not self.command.is_named_by_text:
            for path in recordings_in(vars(one)).values():
                write_lines([str(path), ""])
