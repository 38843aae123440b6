# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The texts and the names of elements that a topic has in a recording, for rules to compare with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, is_dataclass
from itertools import islice

from msgspec import Struct

from smarttestudo.language.parser.values import quoted
from smarttestudo.language.properties.field_path import ANY, is_field_path
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.files.recordings import READING
from smarttestudo.ruler.job import Report, job
from smarttestudo.ruler.topics.known_fields import FieldKind

MAX_TEXTS = 50
MAX_FIELDS = 200
_MAX_MESSAGES = 20_000
_LONGEST_TEXT = 200
_DEEPEST = 5
_KEYS = ("name", "key")


class RecordedWordsRequest(Struct, frozen=True, kw_only=True):
    """A topic of a bag; ``run`` names the work in ``Progress`` messages of ``/ws``."""

    bag: str
    topic: str
    run: str = ""


class RecordedField(Struct, frozen=True, kw_only=True):
    """A field by its path, as checks write it, and the first 50 texts that it had, sorted."""

    path: str
    kind: FieldKind
    texts: tuple[str, ...]


class RecordedWords(Struct, frozen=True, kw_only=True):
    """Fields of a topic in its first 20 000 messages; those of named elements are after those of any."""

    fields: tuple[RecordedField, ...]


@job("POST /api/recording/words", reads=True, limit=READING)
def recorded_words(request: RecordedWordsRequest, folder: ProjectFolder, report: Report) -> RecordedWords:
    """Read one topic of a bag; ``RecordingError`` where the bag cannot be read."""
    from smarttestudo.bags.definitions import RosbagDecoder  # noqa: PLC0415  most projects have no bag
    from smarttestudo.bags.reader import open_recording  # noqa: PLC0415
    from smarttestudo.domain.errors import RecordingError  # noqa: PLC0415

    found = _Found()
    decoder = RosbagDecoder()
    with open_recording(folder.bag(request.bag)) as recording:
        length_ns = max(recording.end_ns - recording.start_ns, 1)
        for channel, stamp_ns, payload in islice(recording.messages({request.topic}), _MAX_MESSAGES):
            try:
                found.add(decoder.decode(channel, payload))
            except RecordingError:
                continue
            report((stamp_ns - recording.start_ns) / length_ns)
    return RecordedWords(fields=found.fields())


class _Found:
    """Texts by the paths of their fields, as many as are wanted."""

    def __init__(self) -> None:
        self._kinds: dict[str, FieldKind] = {}
        self._texts: dict[str, set[str]] = {}

    def add(self, message: object) -> None:
        for path, value in _leaves(message, "", 0):
            kind = _kind(value)
            if path not in self._kinds and len(self._kinds) >= MAX_FIELDS:
                continue
            self._kinds.setdefault(path, kind)
            texts = self._texts.setdefault(path, set())
            if isinstance(value, str) and len(texts) < MAX_TEXTS and _can_be_written(value):
                texts.add(value)

    def fields(self) -> tuple[RecordedField, ...]:
        paths = sorted(self._kinds, key=lambda path: '["' in path)
        return tuple(
            RecordedField(path=path, kind=self._kinds[path], texts=tuple(sorted(self._texts[path])))
            for path in paths
        )


def _kind(value: object) -> FieldKind:
    if isinstance(value, str):
        return FieldKind.TEXT
    return FieldKind.TRUTH if isinstance(value, bool) else FieldKind.NUMBER


def _can_be_written(text: str) -> bool:
    return len(text) <= _LONGEST_TEXT and text.isprintable()


def _leaves(message: object, before: str, depth: int) -> Iterator[tuple[str, object]]:
    """The texts, numbers and truths in a message by their paths; stamps are left out."""
    if not is_dataclass(message) or depth == _DEEPEST:
        return
    for field in fields(message):
        name, value = field.name, getattr(message, field.name)
        path = f"{before}{name}"
        if isinstance(value, str | bool | int | float):
            if name not in {"sec", "nanosec"}:
                yield path, value
        elif is_dataclass(value):
            yield from _leaves(value, f"{path}.", depth + 1)
        elif isinstance(value, list) and value and is_dataclass(value[0]):
            yield from _of_elements(value, path, depth)
        elif len(names := _names_beside(message, name, value)) > 0:
            yield from ((f"{path}{element}", 0.0) for element in names)


def _of_elements(elements: Sequence[object], path: str, depth: int) -> Iterator[tuple[str, object]]:
    for element in elements:
        if ANY not in path:
            yield from _leaves(element, f"{path}{ANY}.", depth + 1)
        name = next((getattr(element, key) for key in _KEYS if hasattr(element, key)), None)
        if isinstance(name, str) and is_field_path(named := f"{path}[{quoted(name)}]"):
            yield from _leaves(element, f"{named}.", depth + 1)


def _names_beside(message: object, name: str, values: object) -> list[str]:
    """The elements of an array beside an array of as many names, in brackets."""
    names = getattr(message, "name", None)
    if name == "name" or not isinstance(names, list) or not hasattr(values, "__len__"):
        return []
    if len(values) != len(names):
        return []
    elements = [f"[{quoted(one)}]" for one in names if isinstance(one, str)]
    return [element for element in elements if is_field_path(f"x{element}")]
