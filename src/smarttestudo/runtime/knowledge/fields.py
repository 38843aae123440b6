# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The fields of a topic's messages that checks read."""

from __future__ import annotations

import math
from collections.abc import Sequence

from smarttestudo.adirf.properties import Reader, value_reader
from smarttestudo.domain.profile import LevelUnit
from smarttestudo.domain.signal import Signal

Reading = tuple[Signal, float | None]
"""A signal's value; ``None`` is unknown."""


class Fields:
    """What the last message of one topic said of each signal; NaN and what is missing are unknown.

    Until the topic's type is known, properties are plain field paths.
    """

    __slots__ = ("_level_unit", "_readers", "_readings", "_signals", "_type_name")

    def __init__(self, signals: Sequence[Signal], type_name: str, level_unit: LevelUnit | None) -> None:
        self._signals = signals
        self._level_unit = level_unit
        self._type_name = type_name
        self._readings = self.unknown_readings()
        self._readers = self._new_readers()

    def __bool__(self) -> bool:
        """Whether any field is read."""
        return bool(self._signals)

    def carry_on(self, before: Fields) -> None:
        """Take over the type, and the last values of the signals that ``before`` reads in the same way."""
        self.change_type(before._type_name)
        if self._type_name == before._type_name and self._level_unit is before._level_unit:
            readers, values = dict(before._readers), dict(before._readings)
            self._readers = [(signal, readers.get(signal, reader)) for signal, reader in self._readers]
            self._readings = [(signal, values.get(signal)) for signal in self._signals]

    def change_type(self, type_name: str) -> None:
        """Read messages of another type from now on; an empty name changes nothing."""
        if type_name not in {"", self._type_name}:
            self._type_name = type_name
            self._readers = self._new_readers()

    def forget(self) -> None:
        """The last message could not be read."""
        self._readings = self.unknown_readings()

    def read(self, message: object) -> list[Signal]:
        """Take the fields of ``message``; returns the signals that it leaves unknown."""
        values = [(signal, reader(message)) for signal, reader in self._readers]
        self._readings = [(signal, None if math.isnan(value) else value) for signal, value in values]
        return [signal for signal, value in self._readings if value is None]

    def readings(self) -> list[Reading]:
        """The last values."""
        return self._readings.copy()

    def unknown_readings(self) -> list[Reading]:
        """All signals as unknown."""
        return [(signal, None) for signal in self._signals]

    def _new_readers(self) -> list[tuple[Signal, Reader]]:
        return [
            (signal, value_reader(self._type_name, signal.property, self._level_unit))
            for signal in self._signals
        ]
