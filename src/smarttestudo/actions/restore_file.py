# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The values that parameters had before rules set them, on disk: a run that is killed has told the next."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from smarttestudo.domain.action import SetValue
from smarttestudo.domain.errors import TestudoError
from smarttestudo.files.whole_file import not_written, whole_file

_CONTENT = "what parameters were before"
_VERSION = 1


class RestoreFileError(TestudoError):
    """A file of values before that cannot be read."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueBefore:
    """The ``value`` that a parameter had; ``given`` are those of ours that it may have now."""

    node: str
    parameter: str
    value: SetValue
    given: tuple[SetValue, ...]


class RestoreFile:
    """The file at ``path``; without one nothing can be remembered."""

    def __init__(self, path: Path | None) -> None:
        self._path = path

    def read(self) -> list[ValueBefore]:
        """The values that a run before has left. Raises ``RestoreFileError``."""
        path = self._path
        if path is None:
            return []
        try:
            record = json.loads(path.read_text(encoding="utf-8"))
            return [_value_before(one) for one in record["parameters"]]
        except FileNotFoundError:
            return []
        except (OSError, ValueError, LookupError, TypeError, RecursionError) as error:
            cause = f"{_CONTENT} cannot be read: {getattr(error, 'strerror', None) or error}"
            raise RestoreFileError(
                cause, place=str(path), remedy="set those parameters yourself, and remove the file"
            ) from error

    def write(self, values: Iterable[ValueBefore]) -> None:
        """Have these on disk from now on, and no others. Raises ``OutputFileError``."""
        path = self._path
        if path is None:
            raise RestoreFileError(
                f"there is no place to write {_CONTENT}", remedy="name one with --restore-file"
            )
        parameters = [
            {"node": one.node, "parameter": one.parameter, "value": one.value, "given": one.given}
            for one in values
        ]
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise not_written(path, _CONTENT, error) from error
        with whole_file(path, _CONTENT) as write:
            # A parameter may be infinite, so this is what Python writes and reads.
            write(json.dumps({"version": _VERSION, "parameters": parameters}, indent=1) + "\n")


def _value_before(record: dict[str, object]) -> ValueBefore:
    node, parameter, value, given = (record[key] for key in ("node", "parameter", "value", "given"))
    if not (isinstance(node, str) and isinstance(parameter, str) and isinstance(given, list)):
        raise ValueError("not a parameter")  # noqa: TRY004 - a stranger's text
    if not all(isinstance(one, SetValue) for one in (value, *given)):
        raise ValueError("not a value")
    return ValueBefore(node=node, parameter=parameter, value=value, given=tuple(given))  # type: ignore[arg-type]
