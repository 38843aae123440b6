# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""relay.c and copies.c under load, with bad messages and slow writes, as sanitizers see it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from compiled_relay import COPIES, SOURCE, compiled

STRESS = Path(__file__).with_name("relay_stress.c")
SECONDS = 5
AT_MOST_S = 120


@pytest.mark.full
@pytest.mark.usefixtures("compiled_relays")
@pytest.mark.parametrize("sanitizer", ["address,undefined", "thread"])
def test_nothing_is_lost_doubled_or_held_up_and_no_memory_is_misused(tmp_path: Path, sanitizer: str) -> None:
    flags = ("-g", f"-fsanitize={sanitizer}", "-fno-sanitize-recover=all", "-I", str(SOURCE.parent))
    stress = compiled(tmp_path, "relay_stress", *flags, str(STRESS), str(COPIES))
    done = subprocess.run(
        [str(stress), str(SECONDS)], capture_output=True, text=True, timeout=AT_MOST_S, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout.split()[0]) > 0
