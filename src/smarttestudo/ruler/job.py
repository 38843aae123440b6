# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Jobs of the page: functions with a request, an answer and, where they take long, a time limit.

A job says by the types of its parameters what it needs: the struct of the request's body, texts of the
address by their names, and parts of the server such as ``ProjectFolder``. Routes, the page's types, progress
and cancelling follow from ``all_jobs``.
"""

from __future__ import annotations

import pkgutil
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from importlib import import_module
from typing import Any, Generic, Literal, ParamSpec, TypeVar, get_type_hints

import msgspec
from msgspec import Struct

from smarttestudo import ruler
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.record import to_json

_P = ParamSpec("_P")
_R = TypeVar("_R")
Report = Callable[[float], None]
"""Called with the share of the work that is done, 0 … 1."""
Pieces = AsyncIterator[bytes]
"""The body of a request that is a file."""


class Permission(Enum):
    """Permission of who asks: to change files and robots, or only to watch."""

    CHANGE = "change"
    WATCH = "watch"


class RequestError(TestudoError):
    """A request that is refused; ``status`` is its HTTP status.

    Other errors may have a ``status``, too; those without are a 422.
    """

    def __init__(self, cause: str, status: int, *, remedy: str | None = None) -> None:
        super().__init__(cause, remedy=remedy)
        self.status = status


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """How long the process of a job may take.

    ``too_long`` is said of a job that takes longer, ``broken`` of a process that ended without an answer.
    """

    limit_s: float
    too_long: TestudoError
    broken: TestudoError


class TextAnswer(Struct, frozen=True, kw_only=True):
    """One text."""

    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Download:
    """An answer that is a .zip file, piece by piece."""

    name: str
    pieces: Iterator[bytes]


PictureType = Literal["image/jpeg", "image/png"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """An answer that is a picture, which never changes at its address."""

    media_type: PictureType
    content: bytes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Job(Generic[_P, _R]):
    """A function that the page can ask for by its ``route``, a method and a path.

    ``reads`` is whether it changes neither a file nor a robot. With a ``limit`` it runs in a process of its
    own, which ends with who asked; ``repeats`` is whether the next process is to be ready before it is asked
    for, and ``failed`` makes an answer of why there is none.
    """

    route: str
    do: Callable[_P, _R]
    reads: bool
    limit: Limit | None
    repeats: bool
    failed: Callable[[TestudoError], object] | None

    def __call__(self, *args: _P.args, **kwargs: _P.kwargs) -> _R:
        return self.do(*args, **kwargs)

    @property
    def method(self) -> str:
        """``GET``, ``POST`` or ``PUT``; empty for a job that only the server asks for."""
        return self.route.partition(" ")[0]

    @property
    def path(self) -> str:
        return self.route.partition(" ")[2]

    @property
    def answered(self) -> Any:
        """The type of the answer."""
        return get_type_hints(self.do)["return"]

    @property
    def needs(self) -> Mapping[str, Any]:
        """The types of the parameters, by their names."""
        return {name: kind for name, kind in get_type_hints(self.do).items() if name != "return"}

    @property
    def asked(self) -> type[Struct] | None:
        """The type of the request's body."""
        kinds = (kind for kind in self.needs.values() if isinstance(kind, type) and issubclass(kind, Struct))
        return next(kinds, None)


def job(
    route: str = "",
    *,
    reads: bool = False,
    limit: Limit | None = None,
    repeats: bool = False,
    failed: Callable[[TestudoError], object] | None = None,
) -> Callable[[Callable[_P, _R]], Job[_P, _R]]:
    """Make a function a job of the page. A GET always only reads."""

    def declared(do: Callable[_P, _R]) -> Job[_P, _R]:
        only_reads = reads or route.startswith("GET ")
        return Job(route=route, do=do, reads=only_reads, limit=limit, repeats=repeats, failed=failed)

    return declared


def all_jobs() -> tuple[Job[..., Any], ...]:
    """The jobs with a route in all modules of the Ruler, by path."""
    names = [module.name for module in pkgutil.walk_packages(ruler.__path__, f"{ruler.__name__}.")]
    jobs = {
        one.route: one
        for name in names
        for one in vars(import_module(name)).values()
        if isinstance(one, Job) and one.route
    }
    return tuple(sorted(jobs.values(), key=lambda one: (one.path, one.method)))


def answer_json(answer: object) -> bytes:
    """Encode ``answer``: a struct as msgspec does, a record as it stands in a status or ``--json``.

    A struct holds no record whose JSON is other than its fields; the generator of the page's types refuses
    one that does.
    """
    return msgspec.json.encode(answer if isinstance(answer, Struct) else to_json(answer))
