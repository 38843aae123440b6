# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Settings of a run: parameters of its node and options of its command line, each declared once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, Generic, TypeVar, cast

from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.parameter import Access, Parameter, ParameterValue

_Value = TypeVar("_Value")
_Value_co = TypeVar("_Value_co", covariant=True)
_Chosen = TypeVar("_Chosen", bound=Enum)
Read = Callable[[ParameterValue], _Value]
"""Gives the value that a parameter or the command line holds; ``ValueError`` says what it is no value of."""


class OptionValueError(ValueError):
    """A value that an option cannot have; its text says what the option is."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Option(Generic[_Value_co]):
    """A setting: ``name`` is the parameter, ``flag`` the option of the command line, if there are such.

    ``default`` is the value where nobody gives one. What ``read`` gave, it reads as the same. ``is_number``:
    a text on the command line is one. ``is_shared``: other commands have it too, and add it by a function of
    theirs. ``is_list``: it may be given several times, each time ``nargs`` values.
    """

    help: str
    read: Read[_Value_co]
    name: str = ""
    default: ParameterValue = ""
    flag: str | None = None
    metavar: str | None = None
    access: Access = Access.NOBODY
    is_typed: bool = True
    is_shared: bool = False
    is_number: bool = False
    is_list: bool = False
    nargs: str | None = None

    @property
    def key(self) -> str:
        """Key of its value: the parameter's name, or else the flag."""
        return self.name or self.flag or ""

    @property
    def attribute(self) -> str:
        """Where the command line has its value."""
        shared = (self.flag or "").removeprefix("--").replace("-", "_")
        return shared if self.is_shared else self.key

    def from_text(self, given: str) -> _Value_co:
        """The value that a text on the command line says; ``ValueError`` where that is none."""
        if not given:
            raise OptionValueError("it is not empty")
        return self.read(_number_in(given) if self.is_number else given)

    @property
    def parameter(self) -> Parameter:
        """The parameter of the node."""
        return Parameter(
            name=self.name,
            description=f"{self.help[:1].upper()}{self.help[1:]}.",
            value=self.default,
            access=self.access,
            is_typed=self.is_typed,
        )

    def value(self, given: ParameterValue) -> _Value_co:
        """The value that a parameter holds. Raises ``UsageError``."""
        try:
            return self.read(given)
        except ValueError as error:
            raise UsageError(
                str(error), place=f"parameter {self.name}" if self.name else self.flag
            ) from error


AnyOption = Option[Any]


class Settings:
    """The values of options; what was not given has its default.

    Raises ``UsageError`` for a value that an option cannot have.
    """

    def __init__(
        self, options: Iterable[AnyOption] = (), given: Mapping[str, ParameterValue] | None = None
    ) -> None:
        values = {key: value for key, value in (given or {}).items() if value is not None}
        self._values = {one: one.value(values.get(one.key, one.default)) for one in options}

    def __getitem__(self, option: Option[_Value]) -> _Value:
        """The value of ``option``."""
        if option not in self._values:
            return option.value(option.default)
        return cast("_Value", self._values[option])


def given_as(value: object) -> ParameterValue:
    """A value of an option as what a parameter holds."""
    if isinstance(value, tuple | list):
        return tuple(map(str, value))
    if isinstance(value, Enum):
        return cast("str", value.value)
    return str(value) if isinstance(value, Path) else cast("ParameterValue", value)


def text(value: ParameterValue) -> str:
    """Any text."""
    return str(value)


def texts(value: ParameterValue) -> tuple[str, ...]:
    """A list of texts."""
    return value if isinstance(value, tuple) else (str(value),)


def is_true(value: ParameterValue) -> bool:
    """Whether it is on."""
    return value is True


def path(value: ParameterValue) -> Path | None:
    """A file or folder; none for an empty text."""
    return Path(str(value)) if value else None


def paths(value: ParameterValue) -> tuple[Path, ...]:
    """Files and folders, one or a list of them."""
    names = value if isinstance(value, tuple) else (value,)
    if not all(isinstance(name, str) for name in names):
        raise OptionValueError("it is a name or a list of names")
    return tuple(Path(str(name)) for name in names if name)


def number(unit: str, least: float, most: float) -> Read[float]:
    """A number of ``unit`` from ``least`` to ``most``."""

    def read(value: ParameterValue) -> float:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not least <= float(cast("float", value)) <= most:
            limits = f"from {_plain(least)} to {_plain(most)}"
            raise OptionValueError(f"{str(value)[:40]!r} is not a number of {unit} {limits}")
        return float(cast("float", value))

    return read


def _number_in(given: str) -> ParameterValue:
    try:
        return float(given)
    except ValueError:
        return given


def _plain(limit: float) -> str:
    return f"{limit:.3f}".rstrip("0").rstrip(".")


def optional(read: Read[_Value]) -> Read[_Value | None]:
    """Wrap ``read`` to give ``None`` where the parameter is not set."""
    return lambda value: None if value is None else read(value)


def choice(kind: type[_Chosen]) -> Read[_Chosen]:
    """One of the members of ``kind``, by its value."""

    def read(value: ParameterValue) -> _Chosen:
        for member in kind:
            if member.value == value:
                return member
        raise OptionValueError(f"it is {' or '.join(str(one.value) for one in kind)}, not {value!r}")

    return read
