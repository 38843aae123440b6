# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files as one .zip, of which no more than a piece is in memory."""

from __future__ import annotations

import io
from pathlib import Path
from zipfile import ZipFile

import pytest

from smarttestudo.files.zip_stream import zip_pieces

MB = 1_000_000


def test_it_holds_the_same_files(tmp_path: Path) -> None:
    contents = {"empty": b"", "one": b"x" * 10, "large": bytes(range(256)) * 4_000}
    for name, data in contents.items():
        (tmp_path / name).write_bytes(data)
    pieces = b"".join(zip_pieces([tmp_path / name for name in contents], "folder"))
    with ZipFile(io.BytesIO(pieces)) as archive:
        assert archive.testzip() is None
        assert {one: archive.read(one) for one in archive.namelist()} == {
            f"folder/{name}": data for name, data in contents.items()
        }


def test_a_piece_is_small_however_large_the_file(tmp_path: Path) -> None:
    with (tmp_path / "large").open("wb") as file:
        file.truncate(50 * MB)
    sizes = [len(piece) for piece in zip_pieces([tmp_path / "large"], "folder")]
    assert sum(sizes) > 50 * MB
    assert max(sizes) < MB


def test_no_link_is_followed(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("secret")
    (tmp_path / "link").symlink_to("file")
    with pytest.raises(OSError, match="symbolic"):
        list(zip_pieces([tmp_path / "link"], "folder"))
