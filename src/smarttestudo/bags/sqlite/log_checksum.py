# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The checksum of a write-ahead log's frames."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_MODULUS = 1 << 32
_MOST_WORDS = (65536 + 8) // 4


class LogChecksum:
    """The checksum over all bytes so far, in 32-bit words of one byte order, ``<`` or ``>``.

    SQLite adds word after word, each time to the sum of the last two results
    (https://www.sqlite.org/fileformat2.html#checksum_algorithm). That is Fibonacci's rule with an input: of n
    words, word k counts F(n − k + 1) times in the result. So a page is two dot products instead of a loop.
    """

    __slots__ = ("_fibonacci", "_sums", "_words")

    def __init__(self, byte_order: str) -> None:
        self._fibonacci = _fibonacci(_MOST_WORDS + 2)
        self._words = np.dtype(f"{byte_order}u4")
        self._sums = (0, 0)

    def add(self, data: bytes) -> tuple[int, int]:
        """The two sums once ``data`` is added: a multiple of 8 bytes, at most a frame of the largest page."""
        words = np.frombuffer(data, self._words).astype(np.uint32)
        fibonacci, count = self._fibonacci, len(words)
        weights = fibonacci[count::-1]
        before, last = self._sums
        sums = (
            int(fibonacci[count - 1]) * before + int(fibonacci[count]) * last + int(weights[1:] @ words),
            int(fibonacci[count]) * before + int(fibonacci[count + 1]) * last + int(weights[:-1] @ words),
        )
        self._sums = (sums[0] % _MODULUS, sums[1] % _MODULUS)
        return self._sums


def _fibonacci(count: int) -> NDArray[np.uint32]:
    """The first ``count`` of 0, 1, 1, 2, 3 …, each modulo 2³²."""
    numbers = [0, 1]
    while len(numbers) < count:
        numbers.append((numbers[-1] + numbers[-2]) % _MODULUS)
    return np.array(numbers[:count], np.uint32)
