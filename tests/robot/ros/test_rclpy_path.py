# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rclpy's executor fails of when it takes a message ends nothing."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from smarttestudo.robot.ros.rclpy_path import ByteTopics, RclpyPath


class Executor:
    """rclpy's, where each take fails."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    def spin_once(self, *, timeout_sec: float) -> None:
        raise self.error


def path_on(error: Exception, said: list[str]) -> RclpyPath:
    node = SimpleNamespace(get_logger=lambda: SimpleNamespace(warning=said.append))
    return RclpyPath(node, Executor(error), node, ByteTopics(node, come_serialized=True), "in a test")


def test_a_take_that_fails_is_said_once() -> None:
    said: list[str] = []
    path = path_on(RuntimeError("failed to take message: bad alloc\n  at rmw.cpp:1"), said)
    for _ in range(3):
        path.wait(0.0)
    assert said == ["a message cannot be taken: failed to take message: bad alloc"]


def test_what_ends_the_context_ends_the_run() -> None:
    with pytest.raises(LookupError):
        path_on(LookupError("shut down"), []).wait(0.0)
