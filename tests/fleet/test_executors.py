# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What every executor promises, and what each does where a worker is lost."""

from __future__ import annotations

import re
import signal
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path

import pytest

from fleet import tasks
from fleet.dask_processes import DaskProcesses, dask_processes
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.fleet.dask_cluster import ClusterError, DaskCluster, open_cluster
from smarttestudo.fleet.executor import Executor, InProcess
from smarttestudo.fleet.processes import Processes

pytestmark = pytest.mark.full
TIMEOUT_S = 60


@contextmanager
def on_dask(cluster: DaskProcesses) -> Iterator[DaskCluster]:
    """The cluster once all its workers are there, so that another is when one is lost."""
    from distributed import Client  # noqa: PLC0415  only full tests need it

    with Client(cluster.address, timeout=TIMEOUT_S, set_as_default=False) as client:
        client.wait_for_workers(len(cluster.workers), timeout=TIMEOUT_S)
    with open_cluster(cluster.address, timeout_s=TIMEOUT_S, otherwise=InProcess()) as executor:
        yield executor


@pytest.fixture(params=["in_process", "in_processes", "on_dask"])
def executor(request: pytest.FixtureRequest) -> Iterator[Executor]:
    if request.param == "on_dask":
        with on_dask(request.getfixturevalue("cluster")) as opened:
            yield opened
    else:
        yield InProcess() if request.param == "in_process" else Processes(2)


def test_results_are_in_the_order_of_the_items(executor: Executor) -> None:
    assert list(executor.map(tasks.square, range(40))) == [number**2 for number in range(40)]
    assert list(executor.map(tasks.slow_first, range(20))) == list(range(20))
    assert list(executor.map(tasks.square, [])) == []
    assert list(executor.notices) == []
    assert executor.failure is None


def test_what_fails_costs_no_other(executor: Executor) -> None:
    results = list(executor.map(tasks.odd_ones_fail, range(8)))
    assert [one for one in results if not isinstance(one, TestudoError)] == [0, 2, 4, 6]
    assert [str(one) for one in results if isinstance(one, TestudoError)] == [
        "bag 1: error: odd; even it out",
        "error: unexpected ZeroDivisionError: by zero",
        "bag 5: error: odd; even it out",
        "error: unexpected ZeroDivisionError: by zero",
    ]
    assert isinstance(results[1], RecordingError)


def test_a_missing_package_is_raised_since_every_item_would_lack_it(executor: Executor) -> None:
    with pytest.raises(ModuleNotFoundError) as raised:
        list(executor.map(tasks.needs_a_package, range(3)))
    assert raised.value.name == "zzz"


def test_no_more_than_a_bounded_number_is_begun_behind_a_slow_item(
    executor: Executor, tmp_path: Path
) -> None:
    with closing(executor.map(partial(tasks.noted, tmp_path), range(200))) as results:
        assert next(results) == 0
        begun = sum(1 for _ in tmp_path.iterdir())
    assert begun <= 20


def test_no_worker_waits_until_the_caller_is_done_with_a_result(tmp_path: Path) -> None:
    with closing(Processes(1).map(partial(tasks.noted, tmp_path), range(200))) as results:
        assert next(results) == 0
        end_s = time.monotonic() + 30
        while not (tmp_path / "1").exists():
            assert time.monotonic() < end_s
            time.sleep(0.01)


def test_it_can_be_closed_before_the_end_and_used_again(executor: Executor) -> None:
    with closing(executor.map(tasks.square, range(100))) as results:
        assert next(results) == 0
    assert list(executor.map(tasks.square, range(3))) == [0, 1, 4]


def test_a_process_that_is_lost_costs_time_and_a_note(tmp_path: Path) -> None:
    executor = Processes(2)
    assert list(executor.map(partial(tasks.dies_once, tmp_path), range(20))) == list(range(20))
    assert executor.notices == ("1 worker ended without an answer and was replaced",)


def test_an_item_that_ends_each_worker_is_named_and_alone() -> None:
    executor = Processes(2)
    results = list(executor.map(tasks.always_dies, range(20)))
    (failed,) = [one for one in results if isinstance(one, TestudoError)]
    assert results.index(failed) == 5
    assert str(failed) == (
        "error: the process that worked on it was ended by SIGKILL, 2 times; "
        "read it alone with --workers 1; if memory was short, use fewer workers"
    )
    assert [one for one in results if one is not failed] == [n for n in range(20) if n != 5]
    assert executor.notices == ("2 workers ended without an answer and were replaced",)


def test_workers_that_are_ended_clean_up(tmp_path: Path) -> None:
    with closing(Processes(2).map(partial(tasks.waits_to_be_ended, tmp_path), range(5))) as results:
        assert next(results) == 0
        end_s = time.monotonic() + 30
        while not any(tmp_path.iterdir()):
            assert time.monotonic() < end_s
            time.sleep(0.01)
    assert list(tmp_path.iterdir()) == []


def test_a_dask_worker_that_is_lost_costs_time(tmp_path: Path) -> None:
    with dask_processes(tmp_path) as started, on_dask(started) as executor:
        assert list(executor.map(partial(tasks.dies_once, tmp_path), range(20))) == list(range(20))
        assert executor.failure is None


def test_an_item_that_ends_dask_workers_is_named_and_alone(tmp_path: Path) -> None:
    # Two are ended at the first try and two at the second. Nobody waits for one to be replaced.
    with dask_processes(tmp_path, workers=5) as started, on_dask(started) as executor:
        results = list(executor.map(tasks.always_dies, range(20)))
    assert [str(one) for one in results if isinstance(one, TestudoError)] == [
        "error: each worker that worked on it was ended; "
        "read it alone, without --dask; if memory was short, use fewer workers a machine"
    ]
    assert [one for one in results if not isinstance(one, TestudoError)] == [n for n in range(20) if n != 5]


@pytest.mark.parametrize("lost", ["scheduler", "workers", "scheduler that stands still"])
def test_what_a_lost_cluster_leaves_is_worked_on_in_another_way(lost: str, tmp_path: Path) -> None:
    with dask_processes(tmp_path) as started, on_dask(started) as executor:
        with closing(executor.map(tasks.slow_first, range(200))) as results:
            assert [next(results), next(results)] == [0, 1]
            if lost == "scheduler that stands still":
                started.scheduler.send_signal(signal.SIGSTOP)
            else:
                for process in (started.scheduler,) if lost == "scheduler" else started.workers:
                    process.kill()
                    process.wait()
            assert list(results) == list(range(2, 200))
        assert isinstance(executor.failure, ClusterError)
        assert re.fullmatch(
            rf"{started.address}: error: (its scheduler is gone|it has no worker any more); "
            r"\d+ recordings went to this machine instead; look at the cluster's own log",
            str(executor.failure),
        )


def refused(address: str, timeout_s: float) -> str:
    """Why there is no cluster."""
    try:
        with open_cluster(address, timeout_s=timeout_s, otherwise=InProcess()):
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
