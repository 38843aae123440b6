# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sets of texts: where a comparison with a text holds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import count

from smarttestudo.domain.signal import Value
from smarttestudo.language.region import Region
from smarttestudo.language.syntax import Operator


@dataclass(frozen=True, slots=True)
class TextRegion:
    """The ``texts``, or with ``is_inverse`` all others. It answers as ``Region`` does."""

    texts: frozenset[str]
    is_inverse: bool = False

    @staticmethod
    def everything() -> TextRegion:
        """All texts."""
        return TextRegion(frozenset(), is_inverse=True)

    @staticmethod
    def where(operator: Operator, text: str) -> TextRegion:
        """The texts that are ``text``, or with any other operator than ``=`` all others."""
        return TextRegion(frozenset((text,)), is_inverse=operator is not Operator.EQUAL)

    @property
    def comparison(self) -> tuple[Operator, str] | None:
        """The comparison with one text that holds here only, ``None`` where there is none."""
        if len(self.texts) != 1:
            return None
        (text,) = self.texts
        return Operator.NOT_EQUAL if self.is_inverse else Operator.EQUAL, text

    @property
    def is_empty(self) -> bool:
        """Whether no text is in it."""
        return not self.texts and not self.is_inverse

    def contains(self, value: Value) -> bool:
        """Whether ``value`` is in it."""
        return (value in self.texts) is not self.is_inverse

    def complement(self) -> TextRegion:
        """The texts outside it."""
        return TextRegion(self.texts, is_inverse=not self.is_inverse)

    def intersection(self, other: TextRegion) -> TextRegion:
        """The texts in both."""
        if self.is_inverse and other.is_inverse:
            return TextRegion(self.texts | other.texts, is_inverse=True)
        if self.is_inverse:
            return TextRegion(other.texts - self.texts)
        return TextRegion(self.texts - other.texts if other.is_inverse else self.texts & other.texts)

    def sample(self) -> str:
        """A text in it; ``ValueError`` when it is empty."""
        if self.is_empty:
            raise ValueError("an empty region holds no text")
        if not self.is_inverse:
            return min(self.texts)
        others = (f"other {number}" if number else "other" for number in count())
        return next(text for text in others if text not in self.texts)


SetOfValues = Region | TextRegion
"""All regions of one signal are of one of the two sorts."""


def union_of(regions: Iterable[SetOfValues]) -> SetOfValues:
    """The values in any of ``regions`` of one signal, of which there is at least one."""
    given = [*regions]
    if isinstance(given[0], TextRegion):
        return intersection_of(region.complement() for region in given).complement()
    return Region.union_of(region for region in given if isinstance(region, Region))


def intersection_of(regions: Iterable[SetOfValues]) -> SetOfValues:
    """The values in all of ``regions`` of one signal, of which there is at least one."""
    first, *others = regions
    if isinstance(first, Region):
        return Region.intersection_of([first, *(region for region in others if isinstance(region, Region))])
    for region in others:
        first = common(first, region)
    return first


def common(first: SetOfValues, second: SetOfValues) -> SetOfValues:
    """The values in both, two regions of one signal."""
    if isinstance(first, Region) and isinstance(second, Region):
        return first.intersection(second)
    if isinstance(first, TextRegion) and isinstance(second, TextRegion):
        return first.intersection(second)
    raise TypeError("a signal has numbers or texts, not both")


def is_part_of(first: SetOfValues, second: SetOfValues) -> bool:
    """Whether ``second``, a region of the same signal, holds all of ``first``."""
    if isinstance(first, Region) and isinstance(second, Region):
        return first.is_within(second)
    return common(first, second.complement()).is_empty
