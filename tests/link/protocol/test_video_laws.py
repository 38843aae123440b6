# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Coded video over any link: all that arrives can be decoded, and it is never old."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.protocol.simulated_link import MS, Ends, Link, S, Source
from link.protocol.test_link_laws import links
from pacing.bitstreams import IDR, NON_IDR_P, PPS, SPS, compressed_image, compressed_video, ffmpeg_packet, nal
from smarttestudo.domain.link import LinkNeeds, MessageOrigin, StreamInfo
from smarttestudo.domain.robot import Qos
from smarttestudo.link.protocol.outbox import VIDEO_PATIENCE_NS, Outbox
from smarttestudo.link.protocol.outgoing_stream import plain
from smarttestudo.pacing.coded_video import VideoFrame

VIDEO = "foxglove_msgs/msg/CompressedVideo"
KEY, DIFFERENCE, PARAMETERS = nal(SPS, PPS, IDR), nal(NON_IDR_P), nal(SPS, PPS)
_MAKERS: dict[str, Callable[[bytes], bytes]] = {
    VIDEO: lambda data: compressed_video(data, "h264"),
    "sensor_msgs/msg/CompressedImage": lambda data: compressed_image(data, "h264"),
    "ffmpeg_image_transport_msgs/msg/FFMPEGPacket": lambda data: ffmpeg_packet(data, "h264"),
}


@dataclass(frozen=True, kw_only=True)
class Camera:
    """Groups of ``group`` frames, after ``first`` ones of a group that began before."""

    type_name: str = VIDEO
    rate_hz: float = 30.0
    group: int = 30
    first: int = 0
    key_bytes: int = 30_000
    bytes: int = 4_000
    has_parameters_alone: bool = False
    to_s: float = 14.0


@dataclass
class VideoEnds(Ends):
    camera: Camera = field(default_factory=Camera)
    sent: list[tuple[int, VideoFrame, bytes]] = field(default_factory=list)

    def run(self, seconds: float) -> None:
        qos = Qos(reliable=True, transient_local=False, depth=10)
        info = StreamInfo(topic="/video", type_name=self.camera.type_name, qos=qos)
        number = self.sender.open(info, 0)
        assert number is not None
        self.at(0, partial(self._film, number, 0))
        super().run(seconds)

    def _film(self, stream: int, count: int, now_ns: int) -> None:
        camera = self.camera
        is_key = count >= camera.first and (count - camera.first) % camera.group == 0
        if is_key and camera.has_parameters_alone:
            self._put(stream, VideoFrame.PARAMETERS, PARAMETERS, now_ns)
        size = camera.key_bytes if is_key else camera.bytes
        data = (nal(IDR) if camera.has_parameters_alone else KEY) if is_key else DIFFERENCE
        frame = VideoFrame.KEY if is_key else VideoFrame.DIFFERENCE
        self._put(stream, frame, data + b"\xff" * size, now_ns)
        next_ns = now_ns + int(S / camera.rate_hz)
        if next_ns < camera.to_s * S:
            self.at(next_ns, partial(self._film, stream, count + 1))

    def _put(self, stream: int, frame: VideoFrame, data: bytes, now_ns: int) -> None:
        # Digits make no start code.
        payload = _MAKERS[self.camera.type_name](data + b"%d" % len(self.sent))
        self.sent.append((now_ns, frame, payload))
        self.sender.put(stream, payload, now_ns, origin=MessageOrigin(topic="/video", stamp_ns=now_ns))

    def got(self) -> list[int]:
        """The places of all that arrived among all that was sent."""
        places = {payload: place for place, (_, _, payload) in enumerate(self.sent)}
        return [places[message.payload] for _, message in self.arrived["/video"]]


def undecodable(frames: Sequence[VideoFrame], got: Sequence[int]) -> list[int]:
    """The places of frames that arrived after the first key frame without the one before them."""
    arrived, found, is_known, decodable, has_parameters = set(got), [], False, True, False
    for place, frame in enumerate(frames):
        begins = frame is not VideoFrame.DIFFERENCE and not has_parameters
        has_parameters = frame is VideoFrame.PARAMETERS
        if begins:
            decodable = is_known = True
        if place not in arrived:
            decodable = False
        elif is_known and not decodable:
            found.append(place)
    return found


cameras = st.builds(
    Camera,
    type_name=st.sampled_from([*_MAKERS]),
    rate_hz=st.sampled_from([2.0, 5.0, 15.0]),
    group=st.integers(1, 40),
    first=st.integers(0, 20),
    key_bytes=st.integers(8, 60_000),
    bytes=st.integers(8, 10_000),
    has_parameters_alone=st.booleans(),
)
others = st.lists(
    st.builds(
        Source,
        topic=st.just("/other"),
        size_bytes=st.integers(8, 50_000),
        rate_hz=st.floats(0.5, 10),
        to_s=st.just(14.0),
    ),
    max_size=1,
)


@settings(max_examples=60)
@given(links(), cameras, others, st.booleans())
def test_all_that_arrives_can_be_decoded_and_in_order(
    link: Link, camera: Camera, sent: list[Source], is_full: bool
) -> None:
    ends = VideoEnds(link, sent, camera=camera)
    ends.sender.follow({"/video": LinkNeeds(is_full=is_full)})
    ends.run(60)
    got = ends.got()
    assert got == sorted(set(got))
    assert got
    assert undecodable([frame for _, frame, _ in ends.sent], got) == []
    counts = ends.sender.counts(0)["/video"]
    if is_full and not counts.overflowed:
        assert got == list(range(len(ends.sent)))


@settings(max_examples=40)
@given(cameras, others)
def test_of_a_link_that_carries_it_nothing_is_left_out(camera: Camera, sent: list[Source]) -> None:
    ends = VideoEnds(Link(((0.0, 50_000_000.0),)), sent, camera=camera)
    ends.run(20)
    last = len(ends.sent) // 2
    assert ends.got()[-last:] == list(range(len(ends.sent)))[-last:]


@pytest.mark.parametrize("group", [15, 30, 90, 100_000])
def test_on_a_link_that_is_too_slow_each_group_begins_and_none_is_old(group: int) -> None:
    camera = Camera(group=group, key_bytes=15_000, to_s=30.0)
    ends = VideoEnds(Link(((0.0, 60_000.0),)), (), camera=camera)
    ends.run(40)
    got, keys = ends.got(), [at for at, (_, frame, _) in enumerate(ends.sent) if frame is VideoFrame.KEY]
    later = [at for at in keys if ends.sent[at][0] > 5 * S]
    assert set(later) <= set(got)
    assert undecodable([frame for _, frame, _ in ends.sent], got) == []
    lengths = [sum(at <= place < at + group for place in got) for at in later[:-1]]
    assert all(length >= 4 for length in lengths)
    ages = [at_ns - message.offered_ns for at_ns, message in ends.arrived["/video"] if at_ns > 5 * S]
    # A key frame takes a quarter of a second of this link.
    assert all(age_ns < 2 * VIDEO_PATIENCE_NS + 400 * MS for age_ns in ages)
    counts = ends.sender.counts(0)["/video"]
    assert counts.sent + counts.replaced == len(ends.sent)


def test_after_an_outage_it_goes_on_with_a_key_frame_that_is_not_old() -> None:
    ends = VideoEnds(Link(((0.0, 2_000_000.0), (4.0, 0.0), (8.0, 2_000_000.0))), (), camera=Camera(to_s=14.0))
    ends.run(20)
    assert undecodable([frame for _, frame, _ in ends.sent], ends.got()) == []
    later = [(at_ns, message) for at_ns, message in ends.arrived["/video"] if at_ns > 9.5 * S]
    assert len(later) >= 4 * 30
    assert all(at_ns - message.offered_ns < 0.5 * S for at_ns, message in later)


@given(
    st.lists(
        st.sampled_from(
            ["key", "difference", "difference", "difference", "image", "unknown", "send", "restart"]
        ),
        max_size=120,
    ),
    st.booleans(),
    st.integers(0, 3),
)
def test_an_outbox_never_sends_a_frame_without_the_one_before_it(
    steps: list[str], is_full: bool, gap: int
) -> None:
    outbox, now_ns, session = Outbox(plain), 0, 0
    outbox.open(1)
    outbox.set_needs(1, LinkNeeds(is_full=is_full))
    frames: list[VideoFrame | None] = []
    sent: list[list[int]] = [[]]
    for step in steps:
        now_ns += gap * 100 * MS
        if step == "restart":
            session += 1
            outbox.restart(session, now_ns)
            sent.append([])
        elif step == "send":
            chunk = outbox.next_chunk(session, 100, now_ns)
            if chunk is not None and chunk.is_last:
                sent[-1].append(int.from_bytes(chunk.body[:4], "big"))
        else:
            frame = {
                "key": VideoFrame.KEY,
                "difference": VideoFrame.DIFFERENCE,
                "unknown": VideoFrame.UNKNOWN,
            }
            frames.append(frame.get(step))
            outbox.put(1, len(frames[:-1]).to_bytes(4, "big") * 5, now_ns, frame=frames[-1])
    first = next((at for at, one in enumerate(frames) if one in (None, VideoFrame.KEY)), len(frames))
    for places in sent:
        for before, place in itertools.pairwise([-1, *places]):
            if place > first and frames[place] in (VideoFrame.DIFFERENCE, VideoFrame.UNKNOWN):
                assert before == place - 1
    counts = dict(outbox.counts(now_ns))[1]
    waiting = 0
    while (chunk := outbox.next_chunk(session, 100, now_ns)) is not None:
        waiting += chunk.is_last
    assert replace(counts).sent + counts.replaced + counts.overflowed + waiting >= len(frames) * (session > 0)
