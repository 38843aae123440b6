# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of a child process of the Ruler: one JSON object in, and one of these on each line out."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TypeVar

import msgspec
from msgspec import Struct

from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.answer_json import answer_json
from smarttestudo.ruler.page_words import in_page_words

Report = Callable[[float], None]
_MIN_STEP = 0.01
_Order = TypeVar("_Order", bound=Struct)


class Share(Struct, frozen=True, kw_only=True, tag_field="kind", tag="progress"):
    """How far it is, 0 … 1."""

    share: float


class Done(Struct, frozen=True, kw_only=True, tag_field="kind", tag="result"):
    """The answer to the page, as JSON."""

    result: msgspec.Raw


class Failure(Struct, frozen=True, kw_only=True, tag_field="kind", tag="error"):
    """Why there is no answer."""

    message: str
    place: str | None
    remedy: str | None


def answer_order(kind: type[_Order], work: Callable[[_Order, Report], object]) -> int:
    """Do what standard input asks for and say the result; the exit code of the process."""
    order = msgspec.json.decode(sys.stdin.buffer.read(), type=kind)
    try:
        result = work(order, _Reporter())
    except TestudoError as error:
        said = in_page_words(error)
        _say(Failure(message=said.cause, place=said.place, remedy=said.remedy))
        return 1
    _say(Done(result=msgspec.Raw(answer_json(result))))
    return 0


class _Reporter:
    """Says how far it is, a hundred times at most."""

    def __init__(self) -> None:
        self._said = 0.0

    def __call__(self, share: float) -> None:
        if share >= self._said + _MIN_STEP:
            self._said = share
            _say(Share(share=round(min(share, 1.0), 3)))


def _say(message: Share | Done | Failure) -> None:
    sys.stdout.buffer.write(msgspec.json.encode(message) + b"\n")
    sys.stdout.buffer.flush()
