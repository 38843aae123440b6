# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recording of what arrives over a link."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable
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
from smarttestudo.files.outputs import require_new, write_error
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import PARTIAL_SUFFIX

_FOLDER_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}\Z")
_WRITE_ERRORS = (OSError, struct.error)


class RecordingSink:
    """A ``Sink`` that records each robot into a rosbag2 (mcap) of its own, ``folder/<robot>``.

    Messages are stamped with ``now_ns`` as they arrive, and topics named by ``pattern``, in which ``{robot}``
    may stand beside ``{topic}``. A recording appears under its name at the end; one that cannot go on appears
    at once with what was written until then. Until then it is ``folder/.<robot>.partial``, which is a bag,
    too: what was taken is in it though the process is killed. ``say`` is told where each begins, and ``warn``
    once what goes wrong.

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
        self._said: set[str] = set()

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
        try:
            recording.add(stream, channel)
        except RecordingError as error:
            self._give_up(robot, recording, error)

    def take(self, message: ReceivedMessage) -> None:
        """Record the message of a stream that is open; what is predicted did not arrive."""
        recording = self._recordings.get(message.robot)
        if recording is None or message.is_predicted:
            return
        try:
            recording.write(message.stream, self._now_ns(), message.payload)
        except RecordingError as error:
            self._give_up(message.robot, recording, error)

    def close(self) -> None:
        """Have all recordings appear under their names; the folder goes where there is none."""
        for recording in self._recordings.values():
            if recording is not None:
                try:
                    recording.finish()
                except RecordingError as error:
                    self._say(error)
        self._recordings.clear()
        with suppress(OSError, TestudoError):
            remove(self._folder, (), with_folder=True)

    def _create(self, robot: str) -> _RobotRecording | None:
        try:
            recording = _RobotRecording(self._folder, robot)
        except RecordingError as error:
            self._say(error)
            return None
        self._say_begun(
            f"{robot}: recording into {recording.path} until the end, then {self._folder / robot}"
        )
        return recording

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
        line = str(error)
        if line not in self._said:
            self._said.add(line)
            self._warn(line)


class _RobotRecording:
    """The rosbag2 ``folder/<robot>``, hidden until it is finished. Calls raise ``RecordingError``."""

    def __init__(self, folder: Path, robot: str) -> None:
        if _FOLDER_NAME.match(robot) is None:
            raise RecordingError(
                f"the robot {robot!r} is not recorded, because no folder can have its name",
                place=str(folder),
                remedy="give it a name of letters, digits, _, - and .",
            )
        self._target = folder / robot
        self.path = folder / f".{robot}{PARTIAL_SUFFIX}"
        self._file_name = f"{robot}.mcap"
        self._of_streams: dict[tuple[str, int], StoredChannel] = {}
        self._channels: dict[tuple[str, str], StoredChannel] = {}
        try:
            self.path.mkdir()
            self._writer = McapWriter(self.path / self._file_name)
        except OSError as error:
            raise write_error(self._target, error) from error

    def add(self, stream: StreamInfo, channel: StoredChannel) -> None:
        """Messages of ``stream`` are those of ``channel`` from now on."""
        known = self._channels.setdefault((channel.topic, channel.type_name), channel)
        self._of_streams[stream.topic, stream.publisher] = known
        try:
            self._writer.add(known)
        except _WRITE_ERRORS as error:
            raise write_error(self._target, error) from error

    def write(self, stream: StreamInfo, stamp_ns: int, payload: bytes) -> None:
        """Append a message, unless its stream was never announced."""
        channel = self._of_streams.get((stream.topic, stream.publisher))
        if channel is None:
            return
        try:
            self._writer.write(channel, stamp_ns, payload)
        except _WRITE_ERRORS as error:
            raise write_error(self._target, error) from error

    def finish(self) -> None:
        """Have it appear, whole."""
        try:
            content = self._writer.close()
            text = metadata_text({self._file_name: content}, list(self._channels.values()))
            (self.path / METADATA_NAME).write_text(text, encoding="utf-8")
            self._appear()
        except _WRITE_ERRORS as error:
            raise write_error(self._target, error) from error

    def give_up(self) -> None:
        """Have it appear as it is, if it can."""
        self._writer.abandon()
        with suppress(OSError, RecordingError):
            self._appear()

    def _appear(self) -> None:
        require_new(self._target)
        self.path.rename(self._target)
