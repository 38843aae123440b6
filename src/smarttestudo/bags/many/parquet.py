# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about recordings as Parquet: a folder for each table, to which several runs may add at once."""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Mapping
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from smarttestudo import __version__
from smarttestudo.files.outputs import make_folder
from smarttestudo.files.whole_file import whole_binary_file

_TYPES: Mapping[Any, pa.DataType] = {
    str: pa.string(),
    int: pa.int64(),
    float: pa.float64(),
    tuple[float, ...]: pa.list_(pa.float64()),
    bool: pa.bool_(),
    datetime: pa.timestamp("us", tz="UTC"),
}
OF_EACH_TABLE: Mapping[str, Any] = {"run": str, "written_at": datetime, "version": str}
"""The columns of every table: which command line wrote the row, when, and which SmartTestudo."""


class ParquetFolder:
    """Adds the rows of one run to the tables in ``folder``, a file for each recording.

    A file is there whole or not at all, and no run has the names of another. Nothing is ever rewritten.
    Raises ``OutputFileError`` where ``folder`` cannot be made.
    """

    def __init__(self, folder: Path) -> None:
        # A wrong name must not cost the hours that a fleet takes.
        make_folder(folder)
        self._folder = folder
        self._run = uuid.uuid4().hex
        self._files = 0

    def add(self, table: str, columns: Mapping[str, Any], rows: Iterable[Mapping[str, object]]) -> None:
        """Add ``rows`` of one recording to ``table``, with the types of their ``columns``.

        Raises ``TestudoError`` for what cannot be written.
        """
        common = {"run": self._run, "written_at": datetime.now(tz=timezone.utc), "version": __version__}
        schema = pa.schema([(name, _TYPES[of]) for name, of in {**OF_EACH_TABLE, **columns}.items()])
        content = pa.Table.from_pylist([{**common, **_in_unicode(row)} for row in rows], schema=schema)
        if not content.num_rows:
            return
        sink = pa.BufferOutputStream()
        pq.write_table(content, sink, compression="zstd")
        for folder in (self._folder, self._folder / table):
            make_folder(folder)
        self._files += 1
        path = self._folder / table / f"{self._run}-{self._files:06}.parquet"
        with whole_binary_file(path, "the rows", must_be_new=True) as write:
            write(sink.getvalue().to_pybytes())


def _in_unicode(row: Mapping[str, object]) -> dict[str, object]:
    """``row`` with names of files that are not UTF-8 as Python writes such bytes."""
    return {
        name: value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value
        for name, value in row.items()
    }
