# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bytes of a message in the middleware's buffer, also of one whose size no C int holds."""

from __future__ import annotations

import mmap
from collections.abc import Iterator
from typing import cast

import numpy as np
import pytest

from smarttestudo.robot.ros.rcl.bindings import (
    RclBuffer,
    RclBuffers,
    RclLibrary,
    RclPayload,
    SerializedMessage,
    bytes_at,
)

GIB = 1 << 30
SIZE_BYTES = 4 * GIB + 5


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RclPayload]:
    """So many bytes, of which the first of each GiB is its number; they take no memory."""
    path = tmp_path_factory.mktemp("large") / "sparse"
    with path.open("wb") as file:
        file.truncate(SIZE_BYTES)
        for number in range(5):
            file.seek(number * GIB)
            file.write(bytes([number]))
    with path.open("rb") as sparse, mmap.mmap(sparse.fileno(), SIZE_BYTES, prot=mmap.PROT_READ) as mapped:
        view = np.frombuffer(mapped, dtype=np.uint8)
        message = SerializedMessage(view.ctypes.data, SIZE_BYTES, SIZE_BYTES)
        # A library is asked for buffers only, and to free them.
        yield RclPayload(RclBuffer(message), RclBuffers(cast("RclLibrary", None)))
        del view
    path.unlink()


@pytest.mark.parametrize(
    ("part", "found"),
    [
        (slice(None, None, GIB), bytes(range(5))),
        (slice(None, None, -4 * GIB), b"\x00\x00"),
        (slice(3 * GIB, 3 * GIB + 2), b"\x03\x00"),
        (slice(-5, None), b"\x04\x00\x00\x00\x00"),
        (slice(9, 3), b""),
    ],
)
def test_any_part_of_a_message_beyond_2_gib_is_what_it_holds(
    large: RclPayload, part: slice, found: bytes
) -> None:
    assert large[part] == found


@pytest.mark.parametrize("size_bytes", [0, 1, 2, 7])
def test_every_part_of_a_small_message_is_that_of_its_bytes(size_bytes: int) -> None:
    data = np.arange(1, 8, dtype=np.uint8)
    whole = data.tobytes()[:size_bytes]
    ends = [None, *range(-8, 9)]
    for part in (slice(start, stop, step) for start in ends for stop in ends for step in (None, 1, 2, -1)):
        assert bytes_at(data.ctypes.data, size_bytes, part) == whole[part]
