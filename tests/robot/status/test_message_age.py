# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How old messages are when they are relayed, by their own stamps."""

from __future__ import annotations

import struct

import pytest

from smarttestudo.robot.status import MessageAge

MS = 1_000_000
S = 1_000_000_000


def beginning(stamp_ns: int) -> bytes:
    return b"\x00\x01\x00\x00" + struct.pack("<iI", *divmod(stamp_ns, S))


def test_stamps_give_a_rate_and_the_age_of_the_last_message() -> None:
    age = MessageAge()
    for second in range(1, 9):
        age.note(beginning(second * S), second * S + 40 * MS)
        age.measure(second * S + 500 * MS, 5 * second)
    assert age.stamped_hz == pytest.approx(5)
    assert age.delay_ms == pytest.approx(40)


@pytest.mark.parametrize("bytes_", [b"", b"\x00\x01\x00\x00", beginning(0)])
def test_what_holds_no_stamp_has_no_age(bytes_: bytes) -> None:
    age = MessageAge()
    age.note(bytes_, 7 * S)
    age.measure(8 * S, 1)
    assert (age.stamped_hz, age.delay_ms) == (None, None)
