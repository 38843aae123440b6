# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What arrives over a link, recorded."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path

from smarttestudo.adapters.files.removal import remove
from smarttestudo.adapters.rosbag.qos import stored_qos
from smarttestudo.adapters.rosbag.writer import create_recording, require_new, write_error
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.names import TOPIC_PLACEHOLDER, output_name
from smarttestudo.domain.recording import Channel, RecordingWriter, Storage

_FOLDER_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}\Z")


@dataclass(frozen=True, slots=True, kw_only=True)
class _RobotRecording:
    """``opened`` ends it; ``channels`` are by the topic and the publisher of the robot's stream."""

    opened: ExitStack
    writer: RecordingWriter
    channels: dict[tuple[str, int], Channel] = field(default_factory=dict)


class RecordingSink:
    """A ``Sink`` that records each robot into a rosbag2 (mcap) of its own, ``folder/<robot>``.

    Messages are stamped with ``now_ns`` as they arrive, and topics named by ``pattern``, in which ``{robot}``
    may stand beside ``{topic}``. A recording appears under its name at the end; one that cannot go on appears
    at once with what was written until then. What goes wrong is said to ``warn`` once.

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
    ) -> None:
        output_name("/topic", pattern, "robot")
        require_new(folder)
        try:
            folder.mkdir(parents=True)
        except OSError as error:
            raise write_error(folder, error) from error
        self._folder = folder
        self._warn = warn
        self._now_ns = now_ns
        self._pattern = pattern
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
            channel = Channel(
                topic=output_name(stream.topic, self._pattern, robot),
                type_name=stream.type_name,
                definition=stream.definition or None,
                qos=(stored_qos(stream.qos),),
                transient_local=stream.qos.transient_local,
            )
        except TestudoError as error:
            self._say(error)
            return
        try:
            recording.writer.add(channel)
        except RecordingError as error:
            self._give_up(robot, recording, error)
        else:
            recording.channels[stream.topic, stream.publisher] = channel

    def take(self, message: ReceivedMessage) -> None:
        """Record the message of a stream that is open; what is predicted did not arrive."""
        recording = self._recordings.get(message.robot)
        if recording is None or message.is_predicted:
            return
        channel = recording.channels.get((message.stream.topic, message.stream.publisher))
        if channel is None:
            return
        try:
            recording.writer.write(channel, self._now_ns(), message.payload)
        except RecordingError as error:
            self._give_up(message.robot, recording, error)

    def close(self) -> None:
        """Have all recordings appear under their names; the folder goes where there is none."""
        for recording in self._recordings.values():
            if recording is not None:
                try:
                    recording.opened.close()
                except RecordingError as error:
                    self._say(error)
        self._recordings.clear()
        with suppress(OSError, TestudoError):
            remove(self._folder, (), with_folder=True)

    def _create(self, robot: str) -> _RobotRecording | None:
        opened = ExitStack()
        try:
            path = self._path_of(robot)
            writer = opened.enter_context(create_recording(path, storage=Storage.MCAP, keeps_incomplete=True))
        except RecordingError as error:
            self._say(error)
            return None
        return _RobotRecording(opened=opened, writer=writer)

    def _path_of(self, robot: str) -> Path:
        if _FOLDER_NAME.match(robot) is None:
            raise RecordingError(
                f"the robot {robot!r} is not recorded, because no folder can have its name",
                place=str(self._folder),
                remedy="give it a name of letters, digits, _, - and .",
            )
        return self._folder / robot

    def _give_up(self, robot: str, recording: _RobotRecording, error: RecordingError) -> None:
        self._recordings[robot] = None
        self._say(error)
        with suppress(RecordingError), recording.opened:
            raise error

    def _say(self, error: TestudoError) -> None:
        line = str(error)
        if line not in self._said:
            self._said.add(line)
            self._warn(line)
