# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What ``testudo bag`` and ``replay`` say of many recordings is what they say of each."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import signal
import time
from collections.abc import Callable, Sequence
from multiprocessing import active_children
from pathlib import Path
from threading import Thread

import pytest

from bags.bag_factory import small_mission, write_mcap_file
from bags.many.commands import COMMANDS, Command
from bags.many.dask_processes import DaskProcesses, dask_processes
from docs.code_blocks import blocks_of
from report.bag_desk import Ran

pytestmark = pytest.mark.full

PAGE = "docs/how-to/many-recordings.md"
WITHOUT_TIMES = {"wall_seconds"}


def one_by_one(testudo: Command, command: str, *options: str) -> list[Ran]:
    return [testudo(*command.replace("{}", name).split(), *options) for name in "abc"]


def of_all(command: str) -> list[str]:
    return command.replace("out-{}", "out").replace("/{}", "/*").split()


def timeless(line: str) -> dict[str, object]:
    return {key: value for key, value in json.loads(line).items() if key not in WITHOUT_TIMES}


# Each is worked on by other processes once, for these take seconds to begin.
ON_A_CLUSTER = [COMMANDS[number] for number in (1, 4, 6, 7)]
IN_PROCESSES = [one for one in COMMANDS if one not in ON_A_CLUSTER]


@pytest.mark.parametrize(
    ("command", "workers"), [*((one, "1") for one in COMMANDS), *((one, "2") for one in IN_PROCESSES)]
)
def test_the_json_of_many_is_a_line_for_each_with_what_is_said_of_it_alone(
    command: str, workers: str, testudo: Command, fleet: Path
) -> None:
    ran = testudo(*of_all(command), "--json", "--workers", workers)
    assert (ran.code, ran.err) == (0, "")
    lines = [timeless(line) for line in ran.out.splitlines()]
    alone = [timeless(one.out) for one in one_by_one(testudo, command, "--json")]
    named = [{key: line[key] for key in ("bag", "a", "b") if key in line} for line in lines]
    assert lines == [{**names, **one} for names, one in zip(named, alone, strict=True)]
    assert [Path(str(next(iter(names.values())))).name for names in named] == ["a", "b", "c"]


@pytest.mark.parametrize("command", ON_A_CLUSTER)
def test_a_dask_cluster_gives_the_same_numbers_to_the_last_digit(
    command: str, testudo: Command, fleet: Path, cluster: DaskProcesses
) -> None:
    absolute = of_all(command.replace("sent", f"{fleet}/sent").replace("received", f"{fleet}/received"))
    here = testudo(*absolute, "--json", "--workers", "1")
    shutil.rmtree(fleet / "out", ignore_errors=True)
    there = testudo(*absolute, "--json", "--dask", cluster.address)
    assert (there.code, there.err) == (here.code, here.err) == (0, "")
    assert list(map(timeless, there.out.splitlines())) == list(map(timeless, here.out.splitlines()))
    assert len(there.out.splitlines()) == 3


@pytest.fixture(scope="module")
def twenty(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("twenty")
    for number in range(20):
        write_mcap_file(folder / f"{number:02}.mcap", small_mission(2 + number % 3))
    return folder


def killed_soon(workers: Callable[[], Sequence[int]], count: int) -> Thread:
    """A thread that kills the first of ``workers`` as soon as there are ``count``.

    No sooner: a pool of Python's takes it badly when one ends while another is started.
    """

    def kill() -> None:
        end_s = time.monotonic() + 30
        while len(running := workers()) < count:
            assert time.monotonic() < end_s
            time.sleep(0.01)
        os.kill(running[0], signal.SIGKILL)

    thread = Thread(target=kill)
    thread.start()
    return thread


@pytest.mark.parametrize("where", ["processes", "dask"])
def test_a_worker_that_is_killed_costs_no_number(
    where: str, twenty: Path, testudo: Command, tmp_path: Path
) -> None:
    command = ("bag", "rates", f"{twenty}/*.mcap", "--json")
    here = testudo(*command, "--workers", "1")
    if where == "processes":
        thread = killed_soon(lambda: [child.pid or 0 for child in active_children()], 2)
        ran = testudo(*command, "--workers", "2")
    else:
        with dask_processes(tmp_path) as started:
            thread = killed_soon(lambda: [started.workers[0].pid], 1)
            ran = testudo(*command, "--dask", started.address)
    thread.join()
    assert (ran.code, ran.out) == (0, here.out)
    again = r"\d+ recordings? tried once more, each in a process of its own"
    assert re.fullmatch(rf"(note: a worker ended without an answer: {again}\n)?", ran.err)


def test_a_path_that_is_another_place_for_each_worker_is_refused(testudo: Command, fleet: Path) -> None:
    ran = testudo("bag", "rates", "sent", "--dask", "tcp://127.0.0.1:1")
    assert (ran.code, ran.out) == (2, "")
    assert ran.err == (
        "--dask: error: sent/a is another place for each worker; name recordings from the root, or by a URL\n"
    )


@pytest.mark.parametrize("command", COMMANDS[:-1])
def test_the_csv_of_many_has_one_header_and_names_each_recording(
    command: str, testudo: Command, fleet: Path
) -> None:
    ran = testudo(*of_all(command), "--csv", "--workers", "1")
    alone = one_by_one(testudo, command, "--csv")
    header, *rows = ran.out.splitlines()
    columns = header.split(",")
    own = alone[0].out.splitlines()[0].split(",")
    assert columns[0] in ("bag", "a")
    assert columns[-len(own) :] == own
    assert len(rows) == sum(len(one.out.splitlines()) - 1 for one in alone)
    assert [row.endswith(line) for row, line in zip(rows, alone[0].out.splitlines()[1:], strict=False)]


def test_the_text_of_many_is_that_of_each_and_a_line_that_sums_up(testudo: Command, fleet: Path) -> None:
    tables = [one.out for one in one_by_one(testudo, "bag rates sent/{}")]
    ran = testudo("bag", "rates", "sent")
    *texts, sums = ran.out.rpartition("\n3 recordings: ")
    assert "".join(texts) == "\n".join(tables) + "\n3 recordings: "
    total = [one.json["total"] for one in one_by_one(testudo, "bag rates sent/{}", "--json")]
    assert sums.startswith(f"{sum(one['messages'] for one in total)} messages, ")


def test_a_text_that_names_no_recording_stands_below_its_name(testudo: Command, fleet: Path) -> None:
    alone = one_by_one(testudo, "bag loss sent/{}")
    ran = testudo("bag", "loss", "sent")
    named = [f"sent/{name}\n\n{one.out}" for name, one in zip("abc", alone, strict=True)]
    assert ran.out == "\n".join(named) + "\n3 recordings\n"


def test_what_cannot_be_read_is_named_and_the_rest_is_complete(testudo: Command, fleet: Path) -> None:
    (fleet / "sent" / "b" / "b.mcap").write_bytes(b"")
    (fleet / "sent" / "foreign.mcap").write_text("SELECT * FROM robots")
    write_mcap_file(fleet / "sent" / "cut.mcap", small_mission())
    with (fleet / "sent" / "cut.mcap").open("r+b") as file:
        file.truncate(6_000)
    ran = testudo("bag", "rates", "sent/*", "nowhere", "--json")
    assert ran.code == 1
    assert [json.loads(line)["bag"] for line in ran.out.splitlines()] == ["sent/a", "sent/c", "sent/cut.mcap"]
    expected = "give a rosbag2 folder, a .db3 or an .mcap file"
    errors = [line for line in ran.err.splitlines() if not line.startswith("note: ")]
    assert errors == [
        f"sent/b/b.mcap: error: the file is empty; {expected}",
        f"sent/foreign.mcap: error: not a recording: unknown file header; {expected}",
        f"nowhere: error: no such file or folder; {expected}",
    ]
    text = testudo("bag", "rates", "sent/*", "nowhere", "--workers", "1").out
    assert "\n6 recordings, 3 with an error: " in text


def test_an_error_of_an_option_names_the_recording_as_well(testudo: Command, fleet: Path) -> None:
    (fleet / "rules.adirf").write_text("begin\n    SetFrequency /image 1\nend\n")
    ran = testudo("bag", "accuracy", "sent", "--rules", "rules.adirf", "--workers", "1")
    assert (ran.code, len(ran.err.splitlines())) == (1, 3)
    assert all(
        line.startswith(f"sent/{name}: error: ")
        for line, name in zip(ran.err.splitlines(), "abc", strict=True)
    )


def test_rules_with_an_error_are_named_once(testudo: Command, fleet: Path) -> None:
    (fleet / "rules.adirf").write_text("begin\n    SetFrequency /odom -1\nend\n")
    for command in (COMMANDS[4], COMMANDS[6], COMMANDS[7]):
        ran = testudo(*of_all(command))
        assert (ran.code, ran.out) == (1, "")
        assert ran.err.count("error[") == 1


def test_topics_need_be_in_one_recording_only(testudo: Command, fleet: Path) -> None:
    ran = testudo("bag", "rates", "sent/a", "received/a", "--topics", "/gripper", "--json")
    assert ran.code == 0
    ran = testudo("bag", "rates", "sent/*", "--topics", "/odmo", "--json")
    assert ran.code == 1
    assert ran.err == "sent/a and 2 others: error: no topic /odmo; did you mean /odom?\n"


def test_a_pair_without_a_partner_costs_that_pair(testudo: Command, fleet: Path) -> None:
    shutil.rmtree(fleet / "received" / "b")
    ran = testudo("bag", "loss", "sent", "received", "--json")
    assert ran.code == 1
    assert [json.loads(line)["a"] for line in ran.out.splitlines()] == ["sent/a", "sent/c"]
    assert ran.err.startswith("sent/b: error: received has no recording b; ")


def test_each_replay_has_its_place_in_the_folders_that_are_named(testudo: Command, fleet: Path) -> None:
    outputs = ("--output", "out", "--decisions", "decisions", "--report", "reports")
    ran = testudo("replay", "sent", "--rules", "rules.adirf", *outputs)
    assert ran.code == 0
    assert ran.out.endswith("\n3 recordings\n")
    names = ["a", "b", "c"]
    assert sorted(path.name for path in (fleet / "out").iterdir()) == names
    assert sorted(path.name for path in (fleet / "decisions").iterdir()) == [
        f"{name}.jsonl" for name in names
    ]
    assert sorted(path.name for path in (fleet / "reports").iterdir()) == [f"{name}.html" for name in names]
    testudo("replay", "sent/b", "--rules", "rules.adirf", "--output", "alone", "--decisions", "alone.jsonl")
    assert (fleet / "decisions" / "b.jsonl").read_text() == (fleet / "alone.jsonl").read_text()


def test_the_replays_of_a_folder_are_paired_with_their_recordings(testudo: Command, fleet: Path) -> None:
    (fleet / "sent" / "c").rename(fleet / "c")
    (fleet / "sent" / "r1").mkdir()
    (fleet / "c").rename(fleet / "sent" / "r1" / "c")
    (lines,) = [block.commands for block in blocks_of(PAGE) if "replayed" in block.text]
    for line in lines:
        ran = testudo(*shlex.split(line)[1:])
        assert (ran.code, ran.err) == (0, "")
    assert "sent/r1/c" in ran.out
    assert "replayed/r1/c" in ran.out
    assert ran.out.endswith("\n3 recordings\n")


def test_replays_of_one_name_are_refused_before_one_is_written(testudo: Command, fleet: Path) -> None:
    ran = testudo("replay", "sent", "received", "--rules", "rules.adirf", "--output", "out")
    assert ran.code == 2
    assert ran.err == (
        "error: the output of received/a would be out/a, as that of another recording; "
        "name the recordings of one folder, then those of the next\n"
    )
    assert not (fleet / "out").exists()


def test_outputs_are_below_the_folder_that_is_named_whatever_a_pattern_leaves_open(
    testudo: Command, fleet: Path
) -> None:
    replay = ("replay", "--rules", "rules.adirf", "--output", "out", "--workers", "1")
    ran = testudo(*replay, "sent*/*")
    assert (ran.code, ran.err) == (0, "")
    assert sorted(path.name for path in (fleet / "out").iterdir()) == ["a", "b", "c"]
    ran = testudo(*replay, "se*/../sent/*")
    assert ran.code == 2
    assert "which may be outside of out; name recordings without .. in the path\n" in ran.err


def test_figures_of_each_are_in_a_folder_of_its_own(testudo: Command, fleet: Path) -> None:
    ran = testudo("bag", "rates", "sent/a", "sent/b", "--topics", "/odom", "--figures", "figures")
    assert ran.code == 0
    assert sorted(path.name for path in (fleet / "figures").iterdir()) == ["a", "b"]


@pytest.mark.parametrize("workers", ["0", "-1", "two", "1.5"])
def test_a_number_of_workers_is_a_whole_one(workers: str, testudo: Command) -> None:
    ran = testudo("bag", "rates", "a", "--workers", workers)
    assert ran.code == 2
    assert ran.err == (
        f"--workers: error: {workers!r} is not a whole number of 1 or more; see 'testudo bag rates --help'\n"
    )


def test_bags_of_ros_1_that_are_left_out_are_said_once(testudo: Command, fleet: Path) -> None:
    (fleet / "sent" / "old.bag").write_bytes(b"#ROSBAG V2.0\n")
    left_out = (
        "sent: 1 ROS 1 bag (sent/old.bag) is left out; convert it: rosbags-convert --src old.bag --dst old"
    )
    for command in ("info sent", "compare sent received", "report sent"):
        ran = testudo("bag", *command.split())
        assert (ran.code, ran.err) == (0, f"note: {left_out}\n")
