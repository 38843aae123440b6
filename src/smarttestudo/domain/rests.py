# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rests in long work, in which other threads go on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

_Item = TypeVar("_Item")

Rest = Callable[[], None]
"""Called between two small pieces of work."""


def no_rest() -> None:
    """Go on at once, for work that others wait for."""


def resting(items: Iterable[_Item], rest: Rest) -> Iterator[_Item]:
    """``items``, with a rest before each."""
    for item in items:
        rest()
        yield item
