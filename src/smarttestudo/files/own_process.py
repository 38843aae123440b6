# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Resources of the machine that this process takes."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from pathlib import Path

from smarttestudo.domain.status import ProcessReading

_STATM = Path("/proc/self/statm")


def read_own_process() -> ProcessReading:
    """CPU time and resident memory of this process; the latter on Linux only."""
    resident_bytes = None
    with suppress(OSError):
        resident_pages = int(_STATM.read_text(encoding="ascii").split()[1])
        resident_bytes = resident_pages * os.sysconf("SC_PAGE_SIZE")
    return ProcessReading(
        cpu_ns=time.process_time_ns(), steady_ns=time.monotonic_ns(), resident_bytes=resident_bytes
    )
