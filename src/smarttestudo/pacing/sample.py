# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a pacer is offered and what it gives back."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from smarttestudo.domain.payload import Payload


class WhenSlow(Enum):
    """What a relay does when its target is above its source."""

    PASS = "pass"  # noqa: S105 - a mode, not a password
    REPEAT = "repeat"


class StreamKind(Enum):
    """How the messages of a topic belong together, which decides how they are thinned."""

    VOLATILE = "volatile"
    TRANSIENT_LOCAL = "transient_local"
    TRANSFORMS = "transforms"

    @staticmethod
    def of(*, type_name: str, transient_local: bool) -> StreamKind:
        """The kind of a topic of this ROS type and durability; /tf_static is latched before it is /tf."""
        if transient_local:
            return StreamKind.TRANSIENT_LOCAL
        return StreamKind.TRANSFORMS if type_name == "tf2_msgs/msg/TFMessage" else StreamKind.VOLATILE


@dataclass(slots=True, kw_only=True, eq=False)
class Sample:
    """One message of a source; two samples are equal only if they are the same one.

    ``publisher`` tells publishers of one topic apart, where that can be told. ``frames`` are the child
    frames of a TFMessage (``cdr.child_frames``), ``stamp`` is ``cdr.header_stamp`` where topics are paced
    together. Treat it as immutable; it is not frozen because a frozen dataclass is three times slower
    to make, and one is made for every message.
    """

    payload: Payload
    size_bytes: int
    publisher: Hashable = None
    frames: tuple[str, ...] = ()
    stamp: bytes | None = None


class Pass(NamedTuple):
    """A sample to relay now; ``repeated`` says that it was relayed before."""

    sample: Sample
    repeated: bool = False
