# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a relay that ends has let pass was published, and what it still held goes back."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from compiled_relay import GID_BYTES, ListedRcl, library_in
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.robot.ros.rcl.relay_library import RelayLibrary

pytestmark = pytest.mark.contract

FIRST, SECOND = b"\x01" * GID_BYTES, b"\x02" * GID_BYTES
TIMEOUT_S = 60.0


@pytest.fixture
def library(compiled_relays: None, tmp_path: Path) -> RelayLibrary:
    return library_in(tmp_path)


class SlowRcl(ListedRcl):
    """Each write takes ``write_ns``."""

    write_ns = 0

    def _publish(self, publisher: int, sent: object, allocation: int) -> int:
        code = super()._publish(publisher, sent, allocation)
        self.now_ns += self.write_ns
        return code


def test_what_comes_due_during_its_last_write_is_not_lost(library: RelayLibrary) -> None:
    rcl = SlowRcl()
    relay = library.new(rcl.settings(period_ns=NS_PER_S))
    for at_ms, publisher, number in ((0, FIRST, 1), (300, SECOND, 1), (350, FIRST, 2)):
        rcl.now_ns = at_ms * 10**6
        rcl.to_take.append((publisher, number, publisher + b"%d" % number))
        library.step(relay)
    rcl.now_ns = 650 * 10**6
    rcl.to_take.append((SECOND, 2, SECOND + b"2"))
    assert library.start(relay)
    end_s = time.monotonic() + TIMEOUT_S
    while library.counts(relay).arrived.messages < 4:
        assert time.monotonic() < end_s, "the thread took nothing"
    assert rcl.published == [FIRST + b"1", SECOND + b"1"]
    # The first publisher's last word is due, the second's in a quarter of a second.
    rcl.now_ns, rcl.write_ns = 1_400 * 10**6, NS_PER_S // 2
    library.stop(relay)
    counts = library.counts(relay)
    held = [stream.paced_stream(GID_BYTES).held for stream in library.streams(relay)]
    assert [*rcl.published[2:], *(one[:] for one in held if one is not None)] == [FIRST + b"2", SECOND + b"2"]
    assert counts.relayed.messages == len(rcl.published)
    library.free(relay)
