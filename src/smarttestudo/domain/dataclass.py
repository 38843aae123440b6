# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Dataclasses of the standard library whose methods are compiled when they are first called.

``dataclasses.dataclass`` compiles six methods for each class when it is imported, which was more than half
of what a command takes to start; most classes of a start make no object. A type checker sees the standard
library's decorator.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Iterable
from dataclasses import MISSING, FrozenInstanceError, fields, is_dataclass
from functools import partial
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(*, frozen=False, slots=False, kw_only=False, eq=True, order=False):
        """The decorator ``dataclasses.dataclass`` with these options; its classes act as those do."""

        def decorate(kind: type) -> type:
            if order or any(map(is_dataclass, kind.__bases__)):
                options = {"frozen": frozen, "slots": slots, "kw_only": kw_only, "eq": eq, "order": order}
                return dataclasses.dataclass(**options)(kind)
            return _decorated(kind, frozen=frozen, slots=slots, kw_only=kw_only, eq=eq)

        return decorate


def _decorated(kind: Any, *, frozen: bool, slots: bool, kw_only: bool, eq: bool) -> Any:
    # Where there is none, the standard library makes one of the signature, which would compile that method.
    kind.__doc__ = kind.__doc__ or kind.__name__
    own = vars(kind)
    made: Any = dataclasses.dataclass(init=False, repr=False, eq=False, slots=slots, kw_only=kw_only)(kind)
    made.__dataclass_params__.frozen = frozen
    methods: dict[str, object] = {
        "__init__": _Uncompiled(made, "__init__", partial(_init_source, made, frozen=frozen)),
        "__repr__": _repr_of(field.name for field in fields(made) if field.repr),
    }
    if eq:
        methods["__eq__"] = _Uncompiled(made, "__eq__", partial(_eq_source, made))
        methods["__hash__"] = _Uncompiled(made, "__hash__", partial(_hash_source, made)) if frozen else None
    if frozen and slots:
        methods |= {"__getstate__": _state, "__setstate__": _set_state}
    for name, method in methods.items():
        # A class that has an `__eq__` of its own has None as its hash.
        if own.get(name) is None:
            setattr(made, name, method)
    if frozen:
        made.__setattr__, made.__delattr__ = _refusals(made)
    return made


_Source = tuple[list[str], list[str], dict[str, object]]
"""The parameters of a method, the lines of its body, and what these know by name."""


class _Uncompiled:
    """Stands in the place of a method until somebody asks for it."""

    __slots__ = ("_kind", "_name", "_source")

    def __init__(self, kind: type, name: str, source: Callable[[], _Source]) -> None:
        self._kind = kind
        self._name = name
        self._source = source

    def __get__(self, instance: object, owner: type) -> Any:
        parameters, body, known = self._source()
        lines = [f"def make({', '.join(known)}):", f" def {self._name}({', '.join(parameters)}):"]
        lines += [f"  {line}" for line in body or ["pass"]]
        lines.append(f" return {self._name}")
        found: dict[str, Any] = {}
        # Names of fields are identifiers, and all else in the text stands below.
        exec("\n".join(lines), vars(sys.modules[self._kind.__module__]), found)  # noqa: S102
        method = found["make"](**known)
        method.__qualname__ = f"{self._kind.__qualname__}.{self._name}"
        if self._name == "__init__":
            method.__annotations__ = {each.name: each.type for each in fields(self._kind) if each.init}
        setattr(self._kind, self._name, method)
        return method.__get__(instance, owner)


def _init_source(kind: Any, *, frozen: bool) -> _Source:
    known: dict[str, object] = {"_set": object.__setattr__, "_missing": MISSING}
    by_place, by_name, body = ["self"], ["*"], []
    for each in fields(kind):
        name = value = parameter = each.name
        if each.default_factory is not MISSING:
            known[f"_make_{name}"] = each.default_factory
            parameter = f"{name}=_missing"
            value = f"_make_{name}()" + f" if {name} is _missing else {name}" * each.init
        elif each.default is not MISSING:
            known[f"_of_{name}"] = each.default
            parameter = f"{name}=_of_{name}"
            value = name if each.init else f"_of_{name}"
        elif not each.init:
            continue
        if each.init:
            (by_name if each.kw_only else by_place).append(parameter)
        body.append(f"_set(self, {name!r}, {value})" if frozen else f"self.{name} = {value}")
    if hasattr(kind, "__post_init__"):
        body.append("self.__post_init__()")
    return by_place + by_name * (len(by_name) > 1), body, known


def _eq_source(kind: Any) -> _Source:
    names = [each.name for each in fields(kind) if each.compare]
    values = f"{_tuple_of('self', names)} == {_tuple_of('other', names)}"
    return (
        ["self", "other"],
        [f"return {values} if other.__class__ is self.__class__ else NotImplemented"],
        {},
    )


def _hash_source(kind: Any) -> _Source:
    names = [each.name for each in fields(kind) if (each.compare if each.hash is None else each.hash)]
    return ["self"], [f"return hash({_tuple_of('self', names)})"], {}


def _tuple_of(owner: str, names: Iterable[str]) -> str:
    return "(" + "".join(f"{owner}.{name}, " for name in names) + ")"


def _repr_of(shown: Iterable[str]) -> Callable[[object], str]:
    names = tuple(shown)

    @recursive_repr()
    def text(self: object) -> str:
        values = ", ".join(f"{name}={getattr(self, name)!r}" for name in names)
        return f"{type(self).__qualname__}({values})"

    return text


def _refusals(kind: Any) -> tuple[Callable[[object, str, object], None], Callable[[object, str], None]]:
    names = frozenset(each.name for each in fields(kind))

    def refuse_to_set(self: object, name: str, value: object) -> None:
        if type(self) is kind or name in names:
            raise FrozenInstanceError(f"cannot assign to field {name!r}")
        super(kind, self).__setattr__(name, value)

    def refuse_to_delete(self: object, name: str) -> None:
        if type(self) is kind or name in names:
            raise FrozenInstanceError(f"cannot delete field {name!r}")
        super(kind, self).__delattr__(name)

    return refuse_to_set, refuse_to_delete


def _state(self: Any) -> list[object]:
    return [getattr(self, each.name) for each in fields(self)]


def _set_state(self: Any, state: Iterable[object]) -> None:
    for each, value in zip(fields(self), state, strict=False):
        object.__setattr__(self, each.name, value)
