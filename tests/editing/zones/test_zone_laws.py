# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What holds for zones whatever the rule, and for the rectangles that cover a polygon whatever its shape."""

from __future__ import annotations

import math
from fractions import Fraction
from functools import cache
from itertools import combinations, pairwise, product

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from language.written_rules import WrittenFile, written_files
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.signal import Signal
from smarttestudo.editing import Document, meaning, read_document
from smarttestudo.editing.zones import (
    Cover,
    PolygonError,
    Zone,
    ZoneRectangle,
    covering_rectangles,
    zone_condition,
    zones_in,
)
from smarttestudo.editing.zones.cover import Corner, CoverRectangle
from smarttestudo.language.normal_form import holds, normal_form
from smarttestudo.language.parser.lexer import TokenKind
from smarttestudo.language.syntax import (
    Block,
)
from smarttestudo.language.syntax_walks import (
    checks_in,
)
from smarttestudo.ruler.rules.zones import with_moved_zone, with_new_zone, with_resized_zone

X, Y = Signal("/odom", "pose_x"), Signal("/odom", "pose_y")
THRESHOLDS = range(4)
PLACES = [Fraction(2 * half - 1, 2) for half in range(5)]
CHECKS = st.builds(
    "CheckValue /odom {} {} {}".format,
    st.sampled_from(["pose_x", "pose_y"]),
    st.sampled_from([">", ">=", "<", "<="]),
    st.sampled_from(THRESHOLDS),
)
SHIFTS = st.integers(-300, 300).map(lambda centimetres: centimetres / 100)


def _joined(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    several = st.tuples(st.lists(parts, min_size=2, max_size=4), st.sampled_from([" AND ", " OR "]))
    return several.map(lambda pair: f"({pair[1].join(pair[0])})") | parts.map(lambda part: f"Not {part}")


CONDITIONS = st.recursive(CHECKS, _joined, max_leaves=8)


def document_of(condition: str) -> Document:
    return read_document(f"begin If ({condition}) Then SetFrequency /odom 1 EndIf end", "rules.adirf")


def block_of(document: Document) -> Block:
    (entry,) = document.entries
    assert isinstance(entry.statement, Block)
    return entry.statement


def is_inside(rectangle: ZoneRectangle, x: Fraction, y: Fraction) -> bool:
    return (
        (rectangle.min_x_m is None or rectangle.min_x_m < x)
        and (rectangle.max_x_m is None or x < rectangle.max_x_m)
        and (rectangle.min_y_m is None or rectangle.min_y_m < y)
        and (rectangle.max_y_m is None or y < rectangle.max_y_m)
    )


@given(condition=CONDITIONS)
def test_zones_are_where_the_condition_holds(condition: str) -> None:
    block = block_of(document_of(condition))
    reading = zones_in(block.condition, resolve_topic)
    assume(not reading.is_too_mixed)
    form = normal_form(block.condition, resolve_topic)
    for x, y in product(PLACES, PLACES):
        expected = holds(form, {X: float(x), Y: float(y)})
        assert any(is_inside(zone.rectangle, x, y) for zone in reading.zones) == expected
    assert not reading.holds_elsewhere


@given(condition=CONDITIONS, dx=SHIFTS, dy=SHIFTS)
def test_a_moved_zone_holds_where_it_was_moved_to(condition: str, dx: float, dy: float) -> None:
    before = document_of(condition)
    after = document_of(condition)
    moved = block_of(read_document(with_moved_zone(after, "s1", "/odom", (dx, dy)), "rules.adirf"))
    old, new = (normal_form(one.condition, resolve_topic) for one in (block_of(before), moved))
    for x, y in product(PLACES, PLACES):
        assert holds(old, {X: float(x), Y: float(y)}) == holds(new, {X: float(x) + dx, Y: float(y) + dy})


@given(written=written_files(max_statements=3), dx=SHIFTS, dy=SHIFTS)
@settings(max_examples=60)
def test_moving_a_zone_changes_numbers_and_no_other_byte(written: WrittenFile, dx: float, dy: float) -> None:
    before = read_document(written.text, "rules.adirf")
    for entry in before.entries:
        if not isinstance(entry.statement, Block):
            continue
        after = read_document(with_moved_zone(before, entry.id, "/odom", (dx, dy)), "rules.adirf")
        assert gaps(after) == gaps(before)
        pairs = zip(before.words.tokens, after.words.tokens, strict=True)
        changed = [(old, new) for old, new in pairs if old.text != new.text]
        assert all(old.kind is new.kind is TokenKind.NUMBER for old, new in changed)
        places = [one for one in checks_in(entry.statement.condition) if "pose" in one.property]
        assert len(changed) <= len(places) + sum(one.until is not None for one in places)


def test_where_a_check_of_a_zone_ends_to_hold_moves_with_it() -> None:
    written = "CheckValue /odom pose_x > 5.4 Until < 4 AND CheckValue /odom pose_y < 4 Until >= 4.5"
    moved = with_moved_zone(document_of(written), "s1", "/odom", (0.1, -3))
    expected = "CheckValue /odom pose_x > 5.5 Until < 4.1 AND CheckValue /odom pose_y < 1 Until >= 1.5"
    assert moved == document_of(expected).text


def gaps(document: Document) -> list[str]:
    """What stands between the words: blanks, line ends and comments."""
    words = document.words
    ends = [start + len(token.text) for start, token in zip(words.offsets, words.tokens, strict=True)]
    starts = [*words.offsets, len(document.text)]
    return [document.text[end:start] for end, start in zip([0, *ends], starts, strict=True)]


@cache
def rectangles() -> st.SearchStrategy[ZoneRectangle]:
    def side() -> st.SearchStrategy[tuple[float, float]]:
        cuts = st.lists(st.integers(-2000, 2000), min_size=2, max_size=2, unique=True)
        return cuts.map(lambda pair: (min(pair) / 100, max(pair) / 100))

    return st.builds(
        lambda x, y: ZoneRectangle(min_x_m=x[0], max_x_m=x[1], min_y_m=y[0], max_y_m=y[1]), side(), side()
    )


@given(drawn=rectangles(), other=rectangles())
def test_a_drawn_rectangle_reads_back_as_drawn_and_takes_any_other_sides(
    drawn: ZoneRectangle, other: ZoneRectangle
) -> None:
    empty = read_document("begin\nend\n", "rules.adirf")
    made = read_document(with_new_zone(empty, "/odom", [drawn], into=None, label="Zone 1"), "rules.adirf")
    assert [zone.rectangle for zone in zones_of(made)] == [drawn]
    sized = read_document(with_resized_zone(made, "s1", 0, other), "rules.adirf")
    assert [zone.rectangle for zone in zones_of(sized)] == [other]
    assert gaps(sized) == gaps(made)
    back = with_resized_zone(sized, "s1", 0, drawn)
    assert meaning(block_of(read_document(back, "rules.adirf"))) == meaning(block_of(made))


def zones_of(document: Document) -> list[Zone]:
    return list(zones_in(block_of(document).condition, resolve_topic).zones)


@cache
@st.composite
def polygons(draw: st.DrawFn) -> list[Corner]:
    """Corners around a centre, each farther round than the one before: no two sides cross."""
    count = draw(st.integers(3, 12))
    turns = sorted(draw(st.lists(st.integers(0, 359), min_size=count, max_size=count, unique=True)))
    assume(all(later - earlier < 180 for earlier, later in pairwise([*turns, turns[0] + 360])))
    radii = draw(st.lists(st.integers(50, 900), min_size=count, max_size=count))
    return [
        (round(radius * math.cos(math.radians(turn))), round(radius * math.sin(math.radians(turn))))
        for turn, radius in zip(turns, radii, strict=True)
    ]


@cache
@st.composite
def staircases(draw: st.DrawFn) -> list[Corner]:
    """Columns of different heights beside each other: only upright and level sides."""
    heights = draw(st.lists(st.integers(1, 500), min_size=1, max_size=8))
    top = [(100 * (at + side), height) for at, height in enumerate(heights) for side in (0, 1)]
    return [(0, 0), *top, (100 * len(heights), 0)]


def covered(corners: list[Corner], most: int) -> Cover:
    try:
        return covering_rectangles(corners, max_rectangles=most)
    except PolygonError:
        # Corners that fell on one place or in a line after rounding.
        assume(False)
        raise


@given(corners=polygons() | staircases(), most=st.integers(1, 20))
@settings(max_examples=40, deadline=None)
def test_rectangles_hold_the_polygon_share_no_area_and_stay_within_its_ends(
    corners: list[Corner], most: int
) -> None:
    cover = covered(corners, most)
    assert len(cover.rectangles) <= most
    assert cover.over_cm2 >= 0
    for one, other in combinations(cover.rectangles, 2):
        assert not overlap(one, other)
    xs, ys = zip(*corners, strict=True)
    assert all(min(xs) <= one.min_x_cm < one.max_x_cm <= max(xs) for one in cover.rectangles)
    assert all(min(ys) <= one.min_y_cm < one.max_y_cm <= max(ys) for one in cover.rectangles)
    for x in range(min(xs), max(xs), 37):
        for y in range(min(ys), max(ys), 41):
            place = (x + Fraction(1, 3), y + Fraction(1, 7))
            if naively_inside(corners, place):
                assert sum(holds_place(one, place) for one in cover.rectangles) == 1


@given(corners=staircases())
@settings(max_examples=40, deadline=None)
def test_a_polygon_of_upright_and_level_sides_is_covered_exactly(corners: list[Corner]) -> None:
    assert covering_rectangles(corners, max_rectangles=40, tolerance=0).over_cm2 == 0


@given(
    left=st.integers(-900, 900),
    low=st.integers(-900, 900),
    width=st.integers(1, 999),
    height=st.integers(1, 999),
    most=st.integers(1, 9),
)
def test_an_upright_rectangle_is_its_own_cover(
    left: int, low: int, width: int, height: int, most: int
) -> None:
    right, high = left + width, low + height
    cover = covering_rectangles([(left, low), (right, low), (right, high), (left, high)], max_rectangles=most)
    assert cover.rectangles == (CoverRectangle(min_x_cm=left, max_x_cm=right, min_y_cm=low, max_y_cm=high),)
    assert cover.over_cm2 == 0


@given(corners=polygons(), most=st.integers(1, 12))
@settings(max_examples=25, deadline=None)
def test_the_condition_of_a_cover_reads_back_as_its_rectangles(corners: list[Corner], most: int) -> None:
    found = [
        ZoneRectangle(
            min_x_m=one.min_x_cm / 100,
            max_x_m=one.max_x_cm / 100,
            min_y_m=one.min_y_cm / 100,
            max_y_m=one.max_y_cm / 100,
        )
        for one in covered(corners, most).rectangles
    ]
    read = zones_in(zone_condition("/odom", found), resolve_topic)
    assert [zone.rectangle for zone in read.zones] == found


@pytest.mark.parametrize(
    ("corners", "cause"),
    [
        ([(0, 0), (100, 0)], "the outline encloses no area"),
        ([(0, 0), (100, 0), (200, 0)], "the outline encloses no area"),
        ([(0, 0), (100, 100), (100, 0), (0, 100)], "the outline crosses or touches itself"),
        ([(at, at * at) for at in range(101)], "the outline has 101 corners"),
    ],
)
def test_what_is_no_polygon_is_refused_with_a_remedy(corners: list[Corner], cause: str) -> None:
    with pytest.raises(PolygonError) as refused:
        covering_rectangles(corners)
    assert refused.value.cause == cause
    assert refused.value.remedy


def overlap(one: CoverRectangle, other: CoverRectangle) -> bool:
    return (
        one.min_x_cm < other.max_x_cm
        and other.min_x_cm < one.max_x_cm
        and one.min_y_cm < other.max_y_cm
        and other.min_y_cm < one.max_y_cm
    )


def holds_place(one: CoverRectangle, place: tuple[Fraction, Fraction]) -> bool:
    return one.min_x_cm <= place[0] < one.max_x_cm and one.min_y_cm <= place[1] < one.max_y_cm


def naively_inside(corners: list[Corner], place: tuple[Fraction, Fraction]) -> bool:
    """Whether a ray to the right crosses an odd number of sides."""
    x, y = place
    crossings = 0
    for (x1, y1), (x2, y2) in pairwise([*corners, corners[0]]):
        if (y1 > y) != (y2 > y) and x < x1 + (y - y1) * Fraction(x2 - x1, y2 - y1):
            crossings += 1
    return crossings % 2 == 1
