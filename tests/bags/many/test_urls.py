# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings behind URLs say what the files say, for few bytes, and never hang."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from bags.bag_factory import IMAGE, ODOM, START_NS, BagContent, BagMessage, odometry, small_mission, write_bag
from bags.many.commands import Command
from bags.many.object_store import BUCKET, ObjectStore, object_store
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.recording import Channel, Storage

pytestmark = pytest.mark.full


@pytest.fixture(scope="session")
def store_of_all(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ObjectStore]:
    with pytest.MonkeyPatch.context() as patch:
        for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
            patch.setenv(name, "testing")
        patch.setenv("AWS_DEFAULT_REGION", "us-east-1")
        with object_store() as store:
            patch.setenv("AWS_ENDPOINT_URL", store.url)
            yield store


@pytest.fixture
def store(store_of_all: ObjectStore) -> ObjectStore:
    return store_of_all


def without_names(document: str) -> list[dict[str, object]]:
    return [
        {key: value for key, value in json.loads(line).items() if key not in ("bag", "a", "b")}
        for line in document.splitlines()
    ]


KINDS = [
    (StoragePlugin.MCAP, CompressionMode.NONE),
    (StoragePlugin.MCAP, CompressionMode.STORAGE),
    (StoragePlugin.MCAP, CompressionMode.FILE),
    (StoragePlugin.SQLITE3, CompressionMode.NONE),
]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: f"{kind[0].name}-{kind[1].name}")
@pytest.mark.parametrize("action", ["info", "rates --latency", "loss --topics /odom"])
def test_a_recording_behind_a_url_has_the_numbers_of_its_file(
    action: str,
    kind: tuple[StoragePlugin, CompressionMode],
    store: ObjectStore,
    testudo: Command,
    tmp_path: Path,
) -> None:
    storage, compression = kind
    name = f"{storage.name}-{compression.name}-{action.split(maxsplit=1)[0]}"
    bag = write_bag(tmp_path / name, small_mission(), storage=storage, compression=compression)
    store.put(bag, f"each/{name}")
    command, *options = action.split()
    there, here = (
        testudo("bag", command, place, *options, "--json")
        for place in (f"s3://{BUCKET}/each/{name}", str(bag))
    )
    assert (there.code, there.err.replace(f"s3://{BUCKET}/each", str(tmp_path))) == (0, here.err)
    assert without_names(there.out) == without_names(here.out)
    assert there.json.get("bag", there.json.get("a")) == f"s3://{BUCKET}/each/{name}"


def test_folders_and_patterns_behind_urls_stand_for_what_is_in_them(
    store: ObjectStore, testudo: Command, fleet: Path
) -> None:
    store.put(fleet / "sent", "sent")
    store.put(fleet / "received", "received")
    here = testudo("bag", "loss", "sent", "received", "--json", "--workers", "1")
    for a, b, workers in (("sent", "received", "1"), ("sent/*", "received/*", "2")):
        urls = (f"s3://{BUCKET}/{a}", f"s3://{BUCKET}/{b}")
        there = testudo("bag", "loss", *urls, "--json", "--workers", workers)
        assert there.code == 0
        assert without_names(there.out) == without_names(here.out)
        assert [json.loads(line)["a"] for line in there.out.splitlines()] == [
            f"s3://{BUCKET}/sent/{name}" for name in "abc"
        ]


def test_a_report_over_urls_is_that_over_the_files(store: ObjectStore, testudo: Command, fleet: Path) -> None:
    store.put(fleet / "sent", "reported/r1")
    url = f"s3://{BUCKET}/reported"
    ran = testudo("bag", "report", url, "--json")
    here = testudo("bag", "report", "sent", "--json")
    assert (ran.code, ran.err) == (here.code, here.err) == (0, "wrote report.html\n")
    there = without_names(ran.out)
    assert [one.pop("robot") for one in there] == ["r1"] * 3
    assert there == [
        {key: value for key, value in one.items() if key != "robot"} for one in without_names(here.out)
    ]
    ran = testudo("bag", "report", url, "-o", "urls.html")
    page = (fleet / "urls.html").read_text("utf-8")
    assert f"testudo bag report {url}/r1/a -o {fleet}/r1-a-" in page
    ran = testudo("bag", "report", f"{url}/r1/a", "-o", "one.html")
    assert (ran.code, ran.err) == (0, "")
    assert "Longest gap" in (fleet / "one.html").read_text("utf-8")


def test_a_replay_of_a_recording_behind_a_url_is_written_here(
    store: ObjectStore, testudo: Command, fleet: Path
) -> None:
    store.put(fleet / "sent", "replayed")
    ran = testudo("replay", f"s3://{BUCKET}/replayed", "--rules", "rules.adirf", "--output", "out")
    assert ran.code == 0
    assert sorted(path.name for path in (fleet / "out").iterdir()) == ["a", "b", "c"]


def write_images(folder: Path, *, size_bytes: int, count: int) -> Path:
    """A recording of images with a pose after each."""
    image, frame = Channel(topic="/image", type_name=IMAGE.type_name), bytes([0, 1, 0, 0]) + bytes(size_bytes)
    with create_recording(folder, storage=Storage.MCAP) as writer:
        for number in range(count):
            writer.write(image, START_NS + number * 100_000_000, frame)
            writer.write(Channel(topic="/odom", type_name=ODOM.type_name), START_NS + number, odometry(0, 0))
    (file,) = folder.glob("*.mcap")
    return file


def test_the_rates_of_an_indexed_mcap_fetch_at_most_a_twentieth_of_it(
    store: ObjectStore, testudo: Command, tmp_path: Path
) -> None:
    file = write_images(tmp_path / "large", size_bytes=1_000_000, count=96)
    store.put(file, "large.mcap")
    before = store.sent_bytes
    there = testudo("bag", "rates", f"s3://{BUCKET}/large.mcap", "--json")
    fetched = store.sent_bytes - before
    assert without_names(there.out) == without_names(testudo("bag", "rates", str(file), "--json").out)
    assert fetched <= 0.05 * file.stat().st_size


def test_images_that_arrive_sooner_than_an_answer_are_fetched_with_few_requests(
    store: ObjectStore, testudo: Command, tmp_path: Path
) -> None:
    file = write_images(tmp_path / "small", size_bytes=100_000, count=200)
    store.put(file, "small.mcap")
    before = store.ranges
    there = testudo("bag", "rates", f"s3://{BUCKET}/small.mcap", "--json")
    # One more than the images need: messages may lie before the first chunk, too.
    assert store.ranges - before <= 41
    assert without_names(there.out) == without_names(testudo("bag", "rates", str(file), "--json").out)


def test_what_is_not_there_or_damaged_is_named_and_the_rest_complete(
    store: ObjectStore, testudo: Command, fleet: Path
) -> None:
    (fleet / "sent" / "b" / "b.mcap").write_bytes(b"")
    store.put(fleet / "sent", "odd")
    store.put(fleet / "rules.adirf", "odd/rules.mcap")
    url = f"s3://{BUCKET}/odd"
    ran = testudo("bag", "rates", f"{url}/*", f"{url}/gone.mcap", "zzz://bucket/a", "--json")
    assert ran.code == 1
    assert [json.loads(line)["bag"] for line in ran.out.splitlines()] == [f"{url}/a", f"{url}/c"]
    expected = "give a rosbag2 folder, a .db3 or an .mcap file"
    assert ran.err.splitlines() == [
        f"{url}/b/b.mcap: error: the file is empty; {expected}",
        f"{url}/rules.mcap: error: not a recording: unknown file header; {expected}",
        f"{url}/gone.mcap: error: no such file or folder; {expected}",
        "zzz://bucket/a: error: cannot be fetched: Protocol not known: zzz; "
        "check the URL, the credentials and the network",
    ]


@contextmanager
def silent_server() -> Iterator[str]:
    """The URL of a server that takes connections and never answers."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield f"http://127.0.0.1:{server.getsockname()[1]}"


def test_a_server_that_never_answers_costs_its_timeout(testudo: Command, fleet: Path) -> None:
    with silent_server() as url:
        ran = testudo("bag", "rates", f"{url}/a.mcap", "sent", "--timeout", "0.5", "--json")
    assert ran.code == 1
    assert ran.err == (
        f"{url}/a.mcap: error: cannot be fetched: no answer for 0.5 s; "
        "check the URL, the credentials and the network\n"
    )
    assert len(ran.out.splitlines()) == 3


def test_a_store_that_stops_half_way_is_no_damage(
    store: ObjectStore, testudo: Command, tmp_path: Path
) -> None:
    messages = tuple(
        BagMessage(ODOM.name, START_NS + number * 1_000_000, odometry(number, 0)) for number in range(4000)
    )
    bag = write_bag(tmp_path / "bag", BagContent((ODOM,), messages), storage=StoragePlugin.MCAP)
    (file,) = bag.glob("*.mcap")
    store.put(file, "half.mcap")
    store.fails_after = store.ranges + 6
    try:
        ran = testudo("bag", "loss", f"s3://{BUCKET}/half.mcap", "--timeout", "20")
    finally:
        store.fails_after = None
    assert (ran.code, ran.out) == (1, "")
    assert ran.err.startswith(f"s3://{BUCKET}/half.mcap: error: cannot be fetched: ")
    assert ran.err.count("\n") == 1


def test_a_folder_without_recordings_behind_a_url_is_refused_as_one_here(
    testudo: Command, tmp_path: Path
) -> None:
    (tmp_path / "notes.txt").touch()
    place, expected = tmp_path.as_uri(), "give a rosbag2 folder, a .db3 or an .mcap file"
    refused = testudo("bag", "info", place)
    assert refused.err == f"{place}: error: the folder holds no .db3 or .mcap file; {expected}\n"
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n")
    refused, convert = testudo("bag", "info", place), "convert it: rosbags-convert --src old.bag --dst old"
    assert refused.err == f"{place}/old.bag: error: a ROS 1 bag, not a rosbag2; {convert}\n"
