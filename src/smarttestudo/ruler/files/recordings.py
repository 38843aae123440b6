# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that start from a recording: what it holds, defaults for its topics, and recordings that come in."""

from __future__ import annotations

import asyncio

from msgspec import Struct

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.recording import robots_own
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.files.whole_file import OutputFileError, whole_binary_file
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.job import Limit, Pieces, job


class BagRequest(Struct, frozen=True, kw_only=True):
    """A bag of the project."""

    bag: str


class RecordingAnswer(Struct, frozen=True, kw_only=True):
    """Its topics by name, how long it is, and a rule file that relays every message of them."""

    topics: tuple[str, ...]
    duration_s: float
    rules_text: str


class ReceivedAnswer(Struct, frozen=True, kw_only=True):
    """The name in the project of a recording that came as a file."""

    bag: str


READING = Limit(
    limit_s=600.0,
    too_long=TestudoError("the recording takes longer than ten minutes", remedy="try a shorter one"),
    broken=TestudoError("reading the recording ended without a result", remedy="try testudo bag info on it"),
)
"""The limit of a job that reads a whole recording."""


@job("POST /api/recording", reads=True)
def recording(request: BagRequest, folder: ProjectFolder) -> RecordingAnswer:
    """Topics and length of a bag; ``RecordingError`` where it cannot be read."""
    from smarttestudo.bags.reader import open_recording  # noqa: PLC0415  most projects have no bag

    with open_recording(folder.bag(request.bag)) as opened:
        topics = sorted({one.topic for one in robots_own(opened.channels) if is_topic_name(one.topic)})
        duration_s = max(0.0, (opened.end_ns - opened.start_ns) / NS_PER_S)
    return RecordingAnswer(topics=tuple(topics), duration_s=duration_s, rules_text=defaults_text(topics))


@job("PUT /api/recording")
async def receive_recording(name: str, pieces: Pieces, folder: ProjectFolder) -> ReceivedAnswer:
    """Write the new bag ``name``; whoever leaves early leaves nothing.

    Raises ``OutputFileError`` where there is one of that name, or no room.
    """
    path = folder.new_bag(name)
    try:
        with whole_binary_file(path, "the recording", must_be_new=True) as write:
            async for piece in pieces:
                await asyncio.to_thread(write, piece)
    except OutputFileError as error:
        # Where the project is on this machine is nobody's business on another.
        raise OutputFileError(error.cause, place=name, remedy=error.remedy) from error
    return ReceivedAnswer(bag=name)


def defaults_text(topics: list[str], verb: str = "recorded") -> str:
    """A rule file with a default for each topic: every message, until somebody says less."""
    lines = "".join(f"    SetFrequency {topic} Full\n" for topic in topics)
    return f"// Every message of each {verb} topic: lower what may come less often.\nbegin\n{lines}end\n"
