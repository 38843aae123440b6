# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A message as a pacer sees it, and what a pacer is."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple, Protocol

from smarttestudo.domain.names import short_type_name
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.robot import Payload
from smarttestudo.pacing.cdr import STREAM_TYPES
from smarttestudo.pacing.coded_video import VideoFrame, is_coded_video
from smarttestudo.pacing.reckoning.gauges import Reading


class WhenSlow(Enum):
    """Behaviour of a relay when its target is above its source."""

    PASS = "pass"  # noqa: S105 - a mode, not a password
    REPEAT = "repeat"


class StreamKind(Enum):
    """How the messages of a topic belong together, which decides how they are thinned."""

    VOLATILE = "volatile"
    TRANSIENT_LOCAL = "transient_local"
    NAMED = "named"
    CODED_VIDEO = "coded_video"

    @staticmethod
    def of(*, type_name: str, transient_local: bool) -> StreamKind:
        """The kind of a topic of this ROS type and durability; /tf_static is latched before it is /tf.

        The messages of ``NAMED`` say which streams they belong to (``cdr.STREAM_TYPES``), and those of a
        CompressedImage whether it is coded video.
        """
        if is_coded_video(type_name):
            return StreamKind.CODED_VIDEO
        if transient_local:
            return StreamKind.TRANSIENT_LOCAL
        return StreamKind.NAMED if type_name in STREAM_TYPES else StreamKind.VOLATILE


_PATCHES = frozenset(
    {
        "map_msgs/OccupancyGridUpdate",
        "map_msgs/PointCloud2Update",
        "moveit_msgs/PlanningScene",
        "nav2_msgs/CostmapUpdate",
        "visualization_msgs/InteractiveMarkerUpdate",
    }
)


def is_patch(type_name: str) -> bool:
    """Whether messages of a type change a part of what those before showed: without one, it stays wrong."""
    return short_type_name(type_name) in _PATCHES


@dataclass(slots=True, eq=False)
class Sample:
    """One message of a source; two samples are equal only if they are the same one.

    ``publisher`` tells publishers of one topic apart, where that can be told. ``frames`` are the names of
    the streams in it, such as the child frames of a TFMessage (``cdr.StreamReader``), ``deletion`` says
    whether it deletes markers, and ``frame`` what a message of coded video is to a decoder. ``stamp`` is
    ``cdr.header_stamp`` where topics are paced together, ``readings`` what ``Estimate.read`` made of it where
    the estimate of the topic has bounds, ``channel`` says how to decode it where that is another way than the
    topic's first. Treat it as immutable; frozen or keyword-only it would take two to four times as long to
    make, and one is made for every message.
    """

    payload: Payload
    size_bytes: int
    publisher: Hashable = None
    frames: tuple[str, ...] = ()
    stamp: bytes | None = None
    readings: tuple[Reading | None, ...] = ()
    frame: VideoFrame | None = None
    deletion: int = 0
    channel: Channel | None = None


class Pass(NamedTuple):
    """A sample to relay now; ``repeated`` says that it was relayed before."""

    sample: Sample
    repeated: bool = False


class Pacer(Protocol):
    """Decides which messages of one relayed topic pass: a ``TopicPacer`` or a ``Follower``.

    Times are ns of one clock, the caller's; it may jump back, which starts every grid anew. Call ``wake``
    whenever the clock reaches ``wake_ns``, and before a message of the same time is offered.
    """

    __slots__ = ()

    @property
    def wake_ns(self) -> int | None:
        """When ``wake`` may have something to relay, or earlier; ``None`` while nothing waits."""

    def offer(self, sample: Sample, now_ns: int, /) -> Sequence[Pass]:
        """Pace ``sample``, which arrived: return it if it passes now, else nothing."""

    def wake(self, now_ns: int, /) -> Sequence[Pass]:
        """Samples to relay now without a new one."""

    def set_rate(self, rate_hz: float, now_ns: int, /) -> None:
        """Aim at another rate from now on: infinite is Full, 0 is Off; ValueError if negative or NaN."""

    def forget(self) -> None:
        """The topic has another type now: what is held is of the old one and must not go out."""

    def finish(self) -> None:
        """The recording ended: repeat nothing; what is held still goes out at its own time, by ``wake``."""
