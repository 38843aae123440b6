# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A program that used a link ends with its own exit code."""

from __future__ import annotations

import subprocess
import sys

from link.zenoh.ends import free_endpoint

# A callback is under way when the session is closed, and comes back while the program ends, which takes long.
PROGRAM = """
import sys, threading, time
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.link.zenoh.session import open_session

class SlowOutput:
    closed = False

    def flush(self):
        time.sleep(1)

def hear(sample):
    is_called.set()
    time.sleep(0.3)

def use():
    with open_session(LinkOptions(listen=(sys.argv[1],)), "peer", print) as (session, _):
        kept = session.declare_subscriber("a", hear)
        session.put("a", b"")
        is_called.wait()

is_called = threading.Event()
# Zenoh's threads are daemons where it is used by one.
thread = threading.Thread(target=use, daemon=True)
thread.start()
thread.join()
sys.stdout = SlowOutput()
sys.exit(3)
"""


def test_threads_of_callbacks_do_not_abort_a_program_that_ends() -> None:
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM, free_endpoint()], capture_output=True, text=True, check=False
    )
    assert (ran.returncode, ran.stdout, ran.stderr) == (3, "", "")
