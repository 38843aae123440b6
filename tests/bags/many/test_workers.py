# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What workers promise in this process, in others and on a cluster, and what a lost one costs."""

from __future__ import annotations

import re
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path

import pytest

from bags.many import tasks
from bags.many.dask_processes import DaskProcesses, dask_processes
from smarttestudo.bags.many.dask_cluster import ClusterError, open_cluster
from smarttestudo.bags.many.workers import Workers
from smarttestudo.domain.errors import RecordingError, TestudoError

pytestmark = pytest.mark.full
TIMEOUT_S = 60


@contextmanager
def on_dask(cluster: DaskProcesses) -> Iterator[Workers]:
    """The cluster once all its workers are there, so that another is when one is lost."""
    from distributed import Client  # noqa: PLC0415  only full tests need it

    with Client(cluster.address, timeout=TIMEOUT_S, set_as_default=False) as client:
        client.wait_for_workers(len(cluster.workers), timeout=TIMEOUT_S)
    with open_cluster(cluster.address, timeout_s=TIMEOUT_S) as opened:
        yield Workers(1, opened)


@pytest.fixture(params=["in_process", "in_processes", "on_dask"])
def workers(request: pytest.FixtureRequest) -> Iterator[Workers]:
    if request.param == "on_dask":
        with on_dask(request.getfixturevalue("cluster")) as opened:
            yield opened
    else:
        yield Workers(1 if request.param == "in_process" else 2)


def test_results_are_in_the_order_of_the_items(workers: Workers) -> None:
    assert list(workers.map(tasks.square, range(40))) == [number**2 for number in range(40)]
    assert list(workers.map(tasks.slow_first, range(20))) == list(range(20))
    assert list(workers.map(tasks.square, [])) == []
    assert list(workers.notices) == []
    assert workers.failure is None


def test_what_fails_costs_no_other(workers: Workers) -> None:
    results = list(workers.map(tasks.odd_ones_fail, range(8)))
    assert [one for one in results if not isinstance(one, TestudoError)] == [0, 2, 4, 6]
    assert [str(one) for one in results if isinstance(one, TestudoError)] == [
        "bag 1: error: odd; even it out",
        "error: unexpected ZeroDivisionError: by zero",
        "bag 5: error: odd; even it out",
        "error: unexpected ZeroDivisionError: by zero",
    ]
    assert isinstance(results[1], RecordingError)


def test_a_missing_package_is_raised_since_every_item_would_lack_it(workers: Workers) -> None:
    with pytest.raises(ModuleNotFoundError) as raised:
        list(workers.map(tasks.needs_a_package, range(3)))
    assert raised.value.name == "zzz"


def test_no_more_than_a_bounded_number_is_begun_behind_a_slow_item(workers: Workers, tmp_path: Path) -> None:
    with closing(workers.map(partial(tasks.noted, tmp_path), range(200))) as results:
        assert next(results) == 0
        begun = sum(1 for _ in tmp_path.iterdir())
    assert begun <= 20


def test_no_worker_waits_until_the_caller_is_done_with_a_result(tmp_path: Path) -> None:
    with closing(Workers(2).map(partial(tasks.noted, tmp_path), range(200))) as results:
        assert next(results) == 0
        end_s = time.monotonic() + 30
        while not (tmp_path / "1").exists():
            assert time.monotonic() < end_s
            time.sleep(0.01)


def test_it_can_be_closed_before_the_end_and_used_again(workers: Workers) -> None:
    with closing(workers.map(tasks.square, range(100))) as results:
        assert next(results) == 0
    assert list(workers.map(tasks.square, range(3))) == [0, 1, 4]


def failures(results: Sequence[object]) -> dict[int, str]:
    return {place: str(one) for place, one in enumerate(results) if isinstance(one, TestudoError)}


NAMED = (
    "error: each process that worked on it was ended; "
    "read it alone with --workers 1; if memory was short, use fewer workers"
)


def test_a_process_that_is_lost_costs_time_and_a_note(tmp_path: Path) -> None:
    workers = Workers(2)
    assert list(workers.map(partial(tasks.dies_once, tmp_path), range(20))) == list(range(20))
    (notice,) = workers.notices
    assert re.fullmatch(
        r"a worker ended without an answer: \d recordings? tried once more, each in a process of its own",
        notice,
    )


@pytest.mark.parametrize("culprits", [{0}, {5}, {19}, {5, 6}, {1, 11, 18}], ids=str)
def test_each_item_that_ends_its_process_is_named_and_costs_no_other(culprits: set[int]) -> None:
    results = list(Workers(2).map(partial(tasks.dies, culprits), range(20)))
    assert failures(results) == dict.fromkeys(sorted(culprits), NAMED)
    assert [one for one in results if isinstance(one, int)] == [n for n in range(20) if n not in culprits]


def test_workers_that_are_ended_clean_up(tmp_path: Path) -> None:
    with closing(Workers(2).map(partial(tasks.waits_to_be_ended, tmp_path), range(5))) as results:
        assert next(results) == 0
        end_s = time.monotonic() + 30
        while not any(tmp_path.iterdir()):
            assert time.monotonic() < end_s
            time.sleep(0.01)
    assert list(tmp_path.iterdir()) == []


def test_a_dask_worker_that_is_lost_costs_time(tmp_path: Path) -> None:
    with dask_processes(tmp_path) as started, on_dask(started) as workers:
        assert list(workers.map(partial(tasks.dies_once, tmp_path), range(20))) == list(range(20))
        assert workers.failure is None


@pytest.mark.parametrize("count", [1, 3])
def test_an_item_that_ends_dask_workers_is_named_and_costs_no_other(count: int, tmp_path: Path) -> None:
    # A worker that is ended is not replaced: it may be the last.
    with dask_processes(tmp_path, workers=count) as started, on_dask(started) as workers:
        results = list(workers.map(partial(tasks.dies, {5}), range(20)))
    assert failures(results) == {5: NAMED}
    assert [one for one in results if isinstance(one, int)] == [n for n in range(20) if n != 5]
    assert (workers.failure is None) is (count > 2)


@pytest.mark.parametrize("lost", ["scheduler", "workers", "scheduler that stands still"])
def test_what_a_lost_cluster_leaves_is_worked_on_in_another_way(lost: str, tmp_path: Path) -> None:
    with dask_processes(tmp_path) as started, on_dask(started) as workers:
        with closing(workers.map(tasks.slow_first, range(200))) as results:
            assert [next(results), next(results)] == [0, 1]
            if lost == "scheduler that stands still":
                started.scheduler.send_signal(signal.SIGSTOP)
            else:
                for process in (started.scheduler,) if lost == "scheduler" else started.workers:
                    process.kill()
                    process.wait()
            assert list(results) == list(range(2, 200))
        assert isinstance(workers.failure, ClusterError)
        assert re.fullmatch(
            rf"{started.address}: error: (its scheduler is gone|it has no worker any more); "
            r"\d+ recordings went to this machine instead; look at the cluster's own log",
            str(workers.failure),
        )


def refused(address: str, timeout_s: float) -> str:
    """Why there is no cluster."""
    try:
        with open_cluster(address, timeout_s=timeout_s):
            return ""
    except ClusterError as error:
        return str(error)


def test_a_cluster_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    remedy = "start one with `dask scheduler`, or leave --dask out"
    for address in ("tcp://127.0.0.1:1", "nonsense://"):
        assert refused(address, 1) == f"{address}: error: no Dask scheduler answers there; {remedy}"
    with dask_processes(tmp_path, workers=0) as started:
        address = started.address
        remedy = f"start some with `dask worker {address} --nthreads 1`"
        # A scheduler of a busy machine takes a while to answer, too.
        assert refused(address, 10) == f"{address}: error: the Dask scheduler has no worker; {remedy}"
