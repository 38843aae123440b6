# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A thread of a link misses nothing that it is given or woken for."""

from __future__ import annotations

import threading
from collections.abc import Callable

from smarttestudo.link.worker import AutoResetEvent, Worker

WITHIN_S = 30.0
LONG_S = 3_600.0


def refuse(error: Exception) -> None:
    """Nothing fails."""
    raise AssertionError(error)


def test_an_event_ends_one_wait_however_often_it_was_set() -> None:
    event = AutoResetEvent()
    assert not event.wait(0)
    event.set()
    event.set()
    assert [event.wait(0), event.wait(-1.0)] == [True, False]


def test_an_event_that_many_set_at_once_ends_a_wait_and_fails_for_none() -> None:
    event, barrier, ended = AutoResetEvent(), threading.Barrier(4), list[int]()

    def set_often(number: int) -> None:
        barrier.wait()
        for _ in range(5_000):
            event.set()
        ended.append(number)

    threads = [threading.Thread(target=set_often, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        event.wait(0.001)
    assert sorted(ended) == [0, 1, 2, 3]


def test_tasks_are_done_in_order_by_a_thread_that_rests_for_long() -> None:
    done, is_over = list[int](), threading.Event()
    worker = Worker("test", refuse, lambda: LONG_S)
    worker.start()
    for number in range(1_000):

        def task(number: int = number) -> None:
            done.append(number)

        assert worker.give(task)
    worker.give(is_over.set)
    assert is_over.wait(WITHIN_S)
    worker.close()
    assert done == list(range(1_000))


def test_a_thread_that_is_woken_while_it_looks_looks_again() -> None:
    looks, is_over = list[int](), threading.Event()
    wake: list[Callable[[], None]] = []

    def look() -> float:
        looks.append(len(looks))
        if len(looks) < 100:
            # The news comes after the look, and before the rest.
            wake[0]()
        else:
            is_over.set()
        return LONG_S

    worker = Worker("test", refuse, look)
    wake.append(worker.wake)
    worker.start()
    assert is_over.wait(WITHIN_S)
    worker.close()


def test_a_task_that_fails_costs_itself() -> None:
    failed, is_over = list[str](), threading.Event()
    worker = Worker("test", lambda error: failed.append(str(error)))
    worker.start()

    def fail() -> None:
        raise ValueError("no")

    worker.give(fail)
    worker.give(is_over.set)
    assert is_over.wait(WITHIN_S)
    worker.close()
    assert failed == ["no"]
