# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Records incidents in real time until it is killed: 500 messages a second, a trigger every 300 ms.

usage: writing_process.py FOLDER LOG. Each message holds its number; LOG has, for each that was handed to the
recorder, number, stamp and monotonic time in ns, 8 bytes each.
"""

from __future__ import annotations

import os
import struct
import sys
import time
from pathlib import Path

from incidents.folder_runs import channel
from incidents.incident_runs import recording_rules, trigger
from smarttestudo.domain.errors import TestudoError
from smarttestudo.incidents.background import BackgroundSink
from smarttestudo.incidents.folders import IncidentFolders
from smarttestudo.incidents.recorder import IncidentRecorder

PERIOD_S = 0.002


def fail(name: str, error: TestudoError) -> None:
    raise AssertionError(f"{name}: {error}")


def main() -> None:
    folder, log = Path(sys.argv[1]), os.open(sys.argv[2], os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    rules = recording_rules('Record "one" /odom Before 500 ms After 700 ms')
    sink = BackgroundSink(IncidentFolders(folder, {"/odom": channel("/odom")}), 100_000_000, failed=fail)
    with sink.running():
        recorder = IncidentRecorder(rules, sink, 100_000_000, time.time_ns())
        recorder.on_subscribed("/odom", time.time_ns(), transient_local=False)
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        number, due_s = 0, time.monotonic()
        while True:
            stamp_ns = time.time_ns()
            recorder.on_message("/odom", stamp_ns, struct.pack("<Q", number) + bytes(1000))
            os.write(log, struct.pack("<QQQ", number, stamp_ns, time.monotonic_ns()))
            number += 1
            if number % 150 == 0:
                recorder.begin(trigger(rules, time.time_ns()))
            due_s += PERIOD_S
            time.sleep(max(due_s - time.monotonic(), 0))


main()
