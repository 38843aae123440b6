# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How a field of a record stands in JSON, as its type says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Any, TypeVar, get_args, get_origin

_Method = TypeVar("_Method", bound=Callable[..., object])


@dataclass(frozen=True, slots=True, kw_only=True)
class JsonEntry:
    """How a field stands in its object.

    ``name`` is its key, where that is not the field's name. ``keyed_by`` makes an object of a tuple of
    records, by that field of each; with ``is_merged`` the entries of the record stand in the outer object;
    with ``is_rest`` those of a mapping of records do, and it is read from all objects that no other field
    has; ``are_rows``: each record of the tuple is the list of its fields. ``omits_default``: while it has its
    default it has no entry. ``is_absent``: it never has one. ``is_lenient``: of a text that is read, what
    is not understood is left out, in place of an error. ``has_infinite``: beside a mapping of numbers, the
    entry ``infinite`` says which of the null ones are infinite, and their signs.
    """

    name: str = ""
    keyed_by: str = ""
    is_merged: bool = False
    is_rest: bool = False
    are_rows: bool = False
    omits_default: bool = False
    is_absent: bool = False
    is_lenient: bool = False
    has_infinite: bool = False


@dataclass(frozen=True, slots=True)
class Decimals:
    """So many decimals of a number are written."""

    digits: int


@dataclass(frozen=True, slots=True)
class Significant:
    """So many significant digits of a number are written, and infinite ones as null."""

    digits: int


@dataclass(frozen=True, slots=True)
class AtMost:
    """A number that is read is between this and its negative."""

    most: float


class Mark(Enum):
    """Further mark on the type of a field."""

    MEASURED = "measured"
    """A measurement or a count, which changes all the time."""
    NULL_IS_INFINITE = "null is infinite"


Measured = Annotated[float, Decimals(3), Mark.MEASURED]
"""A measured number, with three decimals."""

Count = Annotated[int, Mark.MEASURED]
"""A number that is counted up."""


def marks(hint: Any) -> tuple[Any, ...]:
    """Everything that the type of a field says beside the type itself."""
    return get_args(hint)[1:] if get_origin(hint) is Annotated else ()


def json_name(member: str | Enum) -> str:
    """Name of a member of a closed set in JSON: its value, and for those of numbers the name."""
    if isinstance(member, str):
        return member
    return member.value if isinstance(member.value, str) else member.name.lower()


def derived(name: str = "", *, omits_default: bool = False) -> Callable[[_Method], _Method]:
    """Write the property as an entry, too; ``name`` is its key, where that is not the property's name.

    Goes below ``@property``. What is read ignores the entry. ``omits_default``: what is false, empty or
    ``None`` has none.
    """

    def marked(method: _Method) -> _Method:
        vars(method)["record_entry"] = JsonEntry(name=name or method.__name__, omits_default=omits_default)
        return method

    return marked


def derived_entry(getter: Any) -> JsonEntry | None:
    """How a property stands in its object, by its ``getter``; ``None`` where it does not."""
    entry: JsonEntry | None = vars(getter).get("record_entry")
    return entry
