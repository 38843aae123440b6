# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A Ctrl-C while rclpy is loaded ends the program, though rclpy's library clears what is raised meanwhile."""

from __future__ import annotations

import subprocess
import sys

import pytest

# The signal comes when the library is looked for, which Python does before that is loaded.
PROGRAM = """
import os, signal, sys
from smarttestudo.robot.ros.loading import load_rclpy

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "rclpy._rclpy_pybind11":
            os.kill(os.getpid(), signal.{signal})

def end(number, frame):
    raise KeyboardInterrupt

signal.signal(signal.{signal}, end)
sys.meta_path.insert(0, Interrupting())
try:
    load_rclpy()
    print("not interrupted")
except KeyboardInterrupt:
    print("interrupted, rclpy", "is" if hasattr(sys.modules.get("rclpy"), "init") else "is not", "there")
"""


@pytest.mark.parametrize("signal", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_waits_until_rclpy_is_there(signal: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(signal=signal)], capture_output=True, text=True, check=True
    )
    assert (done.stdout, done.stderr) == ("interrupted, rclpy is there\n", "")
