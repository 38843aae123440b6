# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recording of what arrives over a link."""

from __future__ import annotations

import itertools
import re
import struct
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from smarttestudo.bags.definitions import TypeLibrary
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import McapWriter
from smarttestudo.bags.metadata_text import METADATA_NAME, metadata_text, offered_qos
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.names import TOPIC_PLACEHOLDER, output_name
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.texts import SayOnce
from smarttestudo.files.outputs import require_new, write_error
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, OutputFileError, whole_file

_FOLDER_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}\Z")
_WRITE_ERRORS = (OSError, struct.error)
_StreamKey = tuple[str, int]


class RecordingSink:
    """A ``Sink`` that records each robot into a rosbag2 (mcap) of its own, ``folder/<robot>``.

    Messages are stamped with ``now_ns`` as they arrive, and topics named by ``pattern``, in which ``{robot}``
    may stand beside ``{topic}``. A recording appears under its name at the end; one that cannot go on appears
    at once with what was written until then. Until then it is ``folder/.<robot>.partial``, which is a bag,
    too: what was taken is in it though the process is killed. A file has one definition of a type: with
    another one, as after an update of the robot, the recording goes on in ``folder/<robot>-2``. ``say`` is
    told where each begins, and ``warn`` once what goes wrong.

    Raises:
        UsageError: the pattern makes no names.
        RecordingError: ``folder`` exists or cannot be made.
    """

    def __init__(
        self,
        folder: Path,
        warn: Callable[[str], None],
        now_ns: Callable[[], int],
        *,
        pattern: str = TOPIC_PLACEHOLDER,
        say: Callable[[str], None] = lambda _: None,
    ) -> None:
        output_name("/topic", pattern, "robot")
        require_new(folder)
        try:
            folder.mkdir(parents=True)
        except OSError as error:
            raise write_error(folder, error) from error
        self._folder = folder
        self._warn = warn
        self._say_begun = say
        self._now_ns = now_ns
        self._pattern = pattern
        self._types = TypeLibrary()
        self._recordings: dict[str, _RobotRecording | None] = {}
        self._warn_once = SayOnce(warn)

    def open(self, robot: str, stream: StreamInfo) -> None:
        """List the stream's topic, with another type where that is another one than before."""
        if robot not in self._recordings:
            self._recordings[robot] = self._create(robot)
        recording = self._recordings[robot]
        if recording is None:
            return
        try:
            channel = self._channel(robot, stream)
        except TestudoError as error:
            self._say(error)
            return
        if recording.has_other_definition(channel):
            recording = self._go_on(robot, recording, channel)
        try:
            if recording is not None:
                recording.add((stream.topic, stream.publisher), channel)
        except RecordingError as error:
            assert recording is not None
            self._give_up(robot, recording, error)

    def write(self, message: ReceivedMessage) -> None:
        """Record the message of a stream that is open; what is predicted did not arrive."""
        recording = self._recordings.get(message.robot)
        if recording is None or message.is_predicted:
            return
        try:
            recording.write(message.stream, self._now_ns(), message.payload)
        except RecordingError as error:
            self._give_up(message.robot, recording, error)

    def forget(self, robot: str, stream: StreamInfo) -> None:
        """Keep what was recorded."""

    def close(self) -> None:
        """Have all recordings appear under their names; the folder goes where there is none."""
        for recording in self._recordings.values():
            if recording is not None:
                self._finish(recording)
        self._recordings.clear()
        with suppress(OSError, TestudoError):
            remove(self._folder, (), with_folder=True)

    def _create(self, robot: str) -> _RobotRecording | None:
        try:
            recording = _RobotRecording(self._folder, robot)
        except RecordingError as error:
            self._say(error)
            return None
        self._say_begun(f"{robot}: recording into {recording.path} until the end, then {recording.target}")
        return recording

    def _go_on(self, robot: str, before: _RobotRecording, channel: StoredChannel) -> _RobotRecording | None:
        """Another recording, with what of the streams of the one before fits to the type of ``channel``."""
        self._finish(before)
        recording = self._recordings[robot] = self._create(robot)
        if recording is None:
            return None
        self._warn(
            f"{robot}: the definition of {channel.type_name} changed; "
            f"the recording goes on in {recording.target}"
        )
        try:
            recording.take_streams(before, channel)
        except RecordingError as error:
            self._give_up(robot, recording, error)
            return None
        return recording

    def _finish(self, recording: _RobotRecording) -> None:
        try:
            recording.finish()
        except RecordingError as error:
            self._say(error)
            recording.give_up()

    def _channel(self, robot: str, stream: StreamInfo) -> StoredChannel:
        topic = output_name(stream.topic, self._pattern, robot)
        known = Channel(topic=topic, type_name=stream.type_name, definition=stream.definition or None)
        definition, digest = self._types.definition_and_digest(known)
        return StoredChannel(
            topic=topic,
            type_name=stream.type_name,
            definition=definition,
            digest=digest,
            qos_text=offered_qos(stream.qos),
        )

    def _give_up(self, robot: str, recording: _RobotRecording, error: RecordingError) -> None:
        self._recordings[robot] = None
        self._say(error)
        recording.give_up()

    def _say(self, error: TestudoError) -> None:
        self._warn_once(str(error))


class _RobotRecording:
    """The rosbag2 ``folder/<robot>``, or the first of ``<robot>-2``, ``<robot>-3`` … that is free.

    It is hidden until it is finished. Calls raise ``RecordingError``.
    """

    def __init__(self, folder: Path, robot: str) -> None:
        if _FOLDER_NAME.match(robot) is None:
            raise RecordingError(
                f"the robot {robot!r} is not recorded, because no folder can have its name",
                place=str(folder),
                remedy="give it a name of letters, digits, _, - and .",
            )
        name = next(
            name for name in _names(robot) if not any(path.exists() for path in _places(folder, name))
        )
        self.target, self.path = _places(folder, name)
        self._file_name = f"{name}.mcap"
        self._of_streams: dict[_StreamKey, StoredChannel] = {}
        self._of_types: dict[str, StoredChannel] = {}
        self._channels: dict[tuple[str, str], StoredChannel] = {}
        try:
            self.path.mkdir()
            self._writer = McapWriter(self.path / self._file_name)
        except OSError as error:
            raise write_error(self.target, error) from error

    def has_other_definition(self, channel: StoredChannel) -> bool:
        """Whether the type of ``channel`` is defined otherwise here, so that messages would be misread."""
        known = self._of_types.get(channel.type_name)
        return known is not None and _are_unlike(known, channel)

    def take_streams(self, before: _RobotRecording, channel: StoredChannel) -> None:
        """Add the streams of another recording, but those that define the type of ``channel`` otherwise."""
        for stream, known in before._of_streams.items():
            if known.type_name != channel.type_name or not _are_unlike(known, channel):
                self.add(stream, known)

    def add(self, stream: _StreamKey, channel: StoredChannel) -> None:
        """Messages of ``stream`` are those of ``channel`` from now on."""
        known = self._channels.setdefault((channel.topic, channel.type_name), channel)
        self._of_streams[stream] = known
        self._of_types.setdefault(channel.type_name, known)
        try:
            self._writer.add(known)
        except _WRITE_ERRORS as error:
            raise write_error(self.target, error) from error

    def write(self, stream: StreamInfo, stamp_ns: int, payload: bytes) -> None:
        """Append a message, unless its stream was never announced."""
        channel = self._of_streams.get((stream.topic, stream.publisher))
        if channel is None:
            return
        try:
            self._writer.write(channel, stamp_ns, payload)
        except _WRITE_ERRORS as error:
            raise write_error(self.target, error) from error

    def finish(self) -> None:
        """Have it appear, whole."""
        try:
            content = self._writer.close()
            text = metadata_text({self._file_name: content}, list(self._channels.values()))
            with whole_file(self.path / METADATA_NAME, METADATA_NAME) as write:
                write(text)
            self._appear()
        except OutputFileError as error:
            raise RecordingError(error.cause, place=str(self.target), remedy=error.remedy) from error
        except _WRITE_ERRORS as error:
            raise write_error(self.target, error) from error

    def give_up(self) -> None:
        """Have it appear as it is, if it can."""
        self._writer.abandon()
        with suppress(OSError, RecordingError):
            self._appear()

    def _appear(self) -> None:
        require_new(self.target)
        self.path.rename(self.target)


def _names(robot: str) -> Iterator[str]:
    yield robot
    for number in itertools.count(2):
        yield f"{robot}-{number}"


def _places(folder: Path, name: str) -> tuple[Path, Path]:
    """Where a recording appears, and where it is until then."""
    return folder / name, folder / f".{name}{PARTIAL_SUFFIX}"


def _are_unlike(one: StoredChannel, other: StoredChannel) -> bool:
    """Whether both have a definition, and not the same; comments do not count where digests are known."""
    if one.digest and other.digest:
        return one.digest != other.digest
    return bool(one.definition and other.definition and one.definition != other.definition)
