# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rows about recordings as Parquet: a folder for each table, to which several runs may add at once."""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Mapping
from datetime import datetime, timezone
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from smarttestudo import __version__
from smarttestudo.bags.many.row_tables import ColumnType, RowTable
from smarttestudo.files.outputs import make_folder
from smarttestudo.files.whole_file import whole_binary_file

_TYPES: Mapping[ColumnType, pa.DataType] = {
    ColumnType.TEXT: pa.string(),
    ColumnType.WHOLE: pa.int64(),
    ColumnType.NUMBER: pa.float64(),
    ColumnType.NUMBERS: pa.list_(pa.float64()),
    ColumnType.FLAG: pa.bool_(),
    ColumnType.TIME: pa.timestamp("us", tz="UTC"),
}


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

    def add(self, table: RowTable, rows: Iterable[Mapping[str, object]]) -> None:
        """Add ``rows`` of one recording to ``table``. Raises ``TestudoError`` for what cannot be written."""
        common = {
            "run": self._run,
            "written_at": datetime.now(tz=timezone.utc),
            "version": __version__,
        }
        columns = table.columns
        schema = pa.schema([(name, _TYPES[of]) for name, of in columns.items()])
        content = pa.Table.from_pylist([{**common, **_in_unicode(row)} for row in rows], schema=schema)
        if not content.num_rows:
            return
        sink = pa.BufferOutputStream()
        pq.write_table(content, sink, compression="zstd")
        for folder in (self._folder, self._folder / table.value):
            make_folder(folder)
        self._files += 1
        path = self._folder / table.value / f"{self._run}-{self._files:06}.parquet"
        with whole_binary_file(path, "the rows", must_be_new=True) as write:
            write(sink.getvalue().to_pybytes())


def _in_unicode(row: Mapping[str, object]) -> dict[str, object]:
    """``row`` with names of files that are not UTF-8 as Python writes such bytes."""
    return {
        name: value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value
        for name, value in row.items()
    }
