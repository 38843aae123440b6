# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Every incident is what somebody cuts who has the whole recording and knows nothing of rings and files."""

from __future__ import annotations

import tempfile
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from bags.bag_factory import BagMessage
from bags.bag_reading import read_with_mcap
from incidents.folder_runs import record_of
from incidents.incident_runs import rules_of, windows
from pacing.test_stream_reader import tf_message
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel
from smarttestudo.loop.inputs import MessageInput
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.replays.incidents import IncidentRequest, incident_cutter

MS = 1_000_000
START_NS = 1_700_000_000_000_000_000
TOPICS = ("/odom", "/scan", "/map", "/tf_static")
LATCHED = ("/map", "/tf_static")
FAR = 5.0


@dataclass(frozen=True)
class Came:
    """A message of the recording; ``keys`` are what it counts for where it is latched."""

    stamp_ns: int
    topic: str
    payload: bytes
    keys: tuple[Hashable, ...]
    x: float = 0.0


@dataclass(frozen=True)
class Recorded:
    """A ``Record``."""

    name: str
    topics: tuple[str, ...]
    before_ms: int
    after_ms: int

    def text(self) -> str:
        topics = " ".join(self.topics)
        return f'Record "{self.name}" {topics} Before {self.before_ms} ms After {self.after_ms} ms'


# What comes next: an odometry with its x, or another message; of static frames, which.
KINDS = st.one_of(
    st.sampled_from((1.0, 7.0)),
    st.sampled_from(("/scan", "/map")),
    st.sets(st.sampled_from("abc"), min_size=1).map(lambda found: tuple(sorted(found))),
)
EVENTS = st.lists(st.tuples(st.sampled_from((0, 1, 10, 40, 200, 700)), KINDS), min_size=1, max_size=50)
LENGTHS_MS = st.sampled_from((0, 1, 10, 250, 1500, 4000))
SPANS = st.tuples(LENGTHS_MS, LENGTHS_MS).filter(any)


def recording_of(events: Sequence[tuple[int, float | str | tuple[str, ...]]]) -> list[Came]:
    came: list[Came] = []
    stamp_ns = START_NS
    for pause_ms, kind in events:
        stamp_ns += pause_ms * MS
        number = len(came)
        payload = number.to_bytes(8, "little")
        if isinstance(kind, float):
            came.append(Came(stamp_ns, "/odom", payload, (), kind))
        elif isinstance(kind, str):
            came.append(Came(stamp_ns, kind, payload, (kind,)))
        else:
            transforms = tf_message([("base", child) for child in kind], number, little_endian=True)
            came.append(Came(stamp_ns, "/tf_static", transforms, kind))
    return came


def cut(came: Sequence[Came], near: Sequence[Recorded], far: Sequence[Recorded], folder: Path) -> None:
    """As ``testudo replay --incidents``, which decodes and relays beside that."""
    texts = ["\n".join(one.text() for one in records) for records in (far, near)]
    rule = f'Rule "Far" If CheckValue /odom x > {FAR:g} Then\n{texts[0]}\nElse\n{texts[1]}\nEndIf'
    rules = rules_of(f"SetFrequency /map Full\n{rule}")
    sources = {
        topic: Channel(topic=topic, type_name="std_msgs/msg/String", transient_local=topic in LATCHED)
        for topic in TOPICS
    }
    loop = RelayLoop(rules, Profile(), START_NS)
    request = IncidentRequest(into=folder, rules_sha256="ab")
    with incident_cutter(request, rules, sources, START_NS) as cutter:
        assert cutter is not None
        cutter.begin(loop.triggers)
        for one in came:
            cutter.on_message(sources[one.topic], one.stamp_ns, one.payload)
            decoded = SimpleNamespace(x=one.x)
            loop.handle(MessageInput(one.stamp_ns, one.topic, one.payload, len(one.payload), decoded))
            cutter.begin(loop.triggers)
        cutter.finish(came[-1].stamp_ns)


def triggers(came: Sequence[Came]) -> list[tuple[int, bool]]:
    """When each side of the block begins to hold, and which that is."""
    found: list[tuple[int, bool]] = []
    for one in came:
        if one.topic == "/odom" and (not found or found[-1][1] != (one.x > FAR)):
            found.append((one.stamp_ns, one.x > FAR))
    return found


def counting(came: Sequence[Came], at_ns: int) -> list[Came]:
    """The latched messages from before ``at_ns`` in whose place no other came before that."""
    last: dict[tuple[str, Hashable], Came] = {}
    for one in came:
        if one.topic in LATCHED and one.stamp_ns < at_ns:
            last |= {(one.topic, key): one for key in one.keys}
    return [one for one in came if one in last.values()]


def in_order(path: Path) -> list[BagMessage]:
    """What a reader finds that goes through one file after the other, as 'ros2 bag play' does."""
    metadata = YAML(typ="safe").load(path / "metadata.yaml")["rosbag2_bagfile_information"]
    names = metadata["relative_file_paths"]
    assert sorted(names) == sorted(file.name for file in path.glob("*.mcap"))
    starts = [file["starting_time"]["nanoseconds_since_epoch"] for file in metadata["files"]]
    assert [file["path"] for file in metadata["files"]] == names
    assert starts == sorted(starts)
    return [message for name in names for message in read_with_mcap(path / name)]


def expect_cut(path: Path, came: Sequence[Came], one: Recorded, moments_ns: Sequence[int]) -> None:
    from_ns, to_ns = moments_ns[0] - one.before_ms * MS, moments_ns[-1] + one.after_ms * MS
    record, found = record_of(path), in_order(path)
    assert (record["from_ns"], record["triggered_ns"], record["to_ns"]) == (from_ns, moments_ns[0], to_ns)
    assert [each["triggered_ns"] for each in record.get("further_moments", [])] == moments_ns[1:]
    before = counting(came, from_ns)
    assert record["latched"] == [{"topic": each.topic, "stamp_ns": each.stamp_ns} for each in before]
    # Before the window is what counted then, and nothing else.
    window = [
        BagMessage(each.topic, each.stamp_ns, each.payload)
        for each in came
        if (each.topic in one.topics or each.topic in LATCHED) and from_ns <= each.stamp_ns <= to_ns
    ]
    assert found == [*(BagMessage(each.topic, from_ns, each.payload) for each in before), *window]

    missing = {(each["topic"], each["reason"], each["from_ns"], each["to_ns"]) for each in record["missing"]}
    end_ns = came[-1].stamp_ns
    late = {(topic, "late", from_ns, START_NS) for topic in one.topics if from_ns < START_NS}
    ended = {(topic, "ended", end_ns, to_ns) for topic in one.topics if to_ns > end_ns}
    assert missing == late | ended


@settings(max_examples=100)
@given(EVENTS, SPANS, SPANS, SPANS)
def test_every_incident_is_what_a_naive_second_opinion_cuts(
    events: list[tuple[int, float | str | tuple[str, ...]]],
    far_span: tuple[int, int],
    scan_span: tuple[int, int],
    near_span: tuple[int, int],
) -> None:
    came = recording_of(events)
    far = [Recorded("far", ("/odom", "/scan"), *far_span), Recorded("scan", ("/scan",), *scan_span)]
    near = [Recorded("near", ("/odom", "/scan"), *near_span)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name, "incidents")
        cut(came, near, far, folder)
        found = {(record["triggered_ns"], record["name"]): path for path, record in records(folder)}
        expected = {
            (moments_ms[0] * MS, one.name): (one, [at_ms * MS for at_ms in moments_ms])
            for of_side, is_far in ((far, True), (near, False))
            for one in of_side
            for moments_ms in windows(
                [stamp_ns // MS for stamp_ns, side in triggers(came) if side is is_far],
                one.before_ms,
                one.after_ms,
            )
        }
        assert found.keys() == expected.keys()
        assert len(list(folder.iterdir())) == len(expected)
        for key, (one, moments_ns) in expected.items():
            expect_cut(found[key], came, one, moments_ns)


def records(folder: Path) -> Iterator[tuple[Path, dict[str, Any]]]:
    for path in folder.iterdir():
        yield path, record_of(path)
