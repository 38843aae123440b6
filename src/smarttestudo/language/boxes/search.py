# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where conditions hold: a search for boxes.

The search is DPLL (M. Davis, G. Logemann, D. Loveland, "A machine program for theorem-proving", CACM 1962)
with regions in the place of truth values: whatever is forced narrows the box at once, an OR with one
possible part is forced, and only then is a part of an OR tried, first true, then false.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from smarttestudo.domain.signal import Signal, Truth
from smarttestudo.language.boxes.box import Box, Domain, Effort
from smarttestudo.language.normal_form import Every, Form, InRegion, Some, negation
from smarttestudo.language.region import Region


def find_box(forms: Iterable[Form], domain: Domain, effort: Effort) -> Box | None:
    """A box in all of which all ``forms`` hold, ``None`` if they never hold together.

    Raises ``TooComplexError`` when ``effort`` is spent before that is known.
    """
    return next(boxes_where(forms, domain, effort), None)


def boxes_where(forms: Iterable[Form], domain: Domain, effort: Effort) -> Iterator[Box]:
    """Disjoint boxes that together are all states in which all ``forms`` hold, found one by one.

    Raises ``TooComplexError`` when ``effort`` is spent.
    """
    search = _Search(domain, effort)
    cases: list[tuple[dict[Signal, Region], tuple[Form, ...]]] = [({}, tuple(forms))]
    while cases:
        box, pending = cases.pop()
        clauses = search.narrow(box, pending)
        if clauses is None:
            continue
        if not clauses:
            yield box
            continue
        narrowest = min(clauses, key=lambda clause: len(clause.parts))
        others = tuple(clause for clause in clauses if clause is not narrowest)
        tried, *rest = narrowest.parts
        otherwise = rest[0] if len(rest) == 1 else Some(tuple(rest))
        cases.append((box, (negation(tried), otherwise, *others)))
        cases.append((dict(box), (tried, *others)))


class _Search:
    __slots__ = ("_domain", "_effort")

    def __init__(self, domain: Domain, effort: Effort) -> None:
        self._domain = domain
        self._effort = effort

    def narrow(self, box: dict[Signal, Region], forms: Iterable[Form]) -> list[Some] | None:
        """Narrow ``box`` by all that ``forms`` force; what is left to choose, ``None`` if they contradict."""
        clauses: list[Some] = []
        forced = list(forms)
        self._effort.spend(len(box) + len(forced))
        while forced:
            while forced:
                form = forced.pop()
                if isinstance(form, Every):
                    forced.extend(form.parts)
                elif isinstance(form, Some):
                    clauses.append(form)
                elif not self._narrow_signal(box, form):
                    return None
            undecided: list[Some] = []
            for clause in clauses:
                possible = self._possible_parts(box, clause)
                if possible is None:
                    continue
                if not possible:
                    return None
                if len(possible) == 1:
                    forced.append(possible[0])
                else:
                    undecided.append(Some(possible))
            clauses = undecided
        return clauses

    def _narrow_signal(self, box: dict[Signal, Region], within: InRegion) -> bool:
        region = self._values(box, within.signal).intersection(within.region)
        box[within.signal] = region
        return not region.is_empty

    def _possible_parts(self, box: Box, clause: Some) -> tuple[Form, ...] | None:
        """The parts that can hold in ``box``; ``None`` if one holds in all of it."""
        possible: list[Form] = []
        for part in clause.parts:
            truth = self._truth(box, part)
            if truth is Truth.TRUE:
                return None
            if truth is Truth.UNKNOWN:
                possible.append(part)
        return tuple(possible)

    def _truth(self, box: Box, form: Form) -> Truth:
        """TRUE if ``form`` holds in all of ``box``, FALSE if nowhere in it; UNKNOWN may be either."""
        if isinstance(form, InRegion):
            self._effort.spend(1)
            values = self._values(box, form.signal)
            common = values.intersection(form.region)
            if common.is_empty:
                return Truth.FALSE
            return Truth.TRUE if common == values else Truth.UNKNOWN
        decisive = Truth.FALSE if isinstance(form, Every) else Truth.TRUE
        settled = True
        for part in form.parts:
            truth = self._truth(box, part)
            if truth is decisive:
                return decisive
            settled = settled and truth is not Truth.UNKNOWN
        if not settled:
            return Truth.UNKNOWN
        return Truth.TRUE if isinstance(form, Every) else Truth.FALSE

    def _values(self, box: Box, signal: Signal) -> Region:
        region = box.get(signal)
        return self._domain(signal) if region is None else region
