# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page's types are those of the server's structs and records.

A field that the server gets is not in the committed file until ``make docs`` writes it. A field that the
server loses is none of the page's types any more, so the page's own type check finds who still reads it.
"""

from __future__ import annotations

import re
import runpy
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Annotated

import pytest
from msgspec import Struct

from smarttestudo.domain.record import Decimals, JsonEntry, Mark, derived

ROOT = Path(__file__).resolve().parents[2]
GUI = ROOT / "gui" / "src"
SCRIPT = runpy.run_path(str(ROOT / "scripts" / "make_api_types.py"))


class Colour(Enum):
    """Of a leaf."""

    GREEN = "green"
    RED = "red"


class Leaf(Struct, kw_only=True, tag_field="kind", tag="leaf", rename={"on_": "on"}):
    """What ``grows``.

    And falls.
    """

    colour: Colour | None
    sides_m: tuple[float | None, ...] = ()
    on_: tuple[str, int] = ("", 0)


class Level(Enum):
    """How high."""

    LOW = 0
    HIGH = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Spot:
    """A place."""

    x_m: Annotated[float, Decimals(3)]
    level: Level | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch:
    """What bears leaves."""

    is_dead: Annotated[bool, JsonEntry(name="dead")]
    tip: Annotated[Spot, JsonEntry(is_merged=True)]
    rate_hz: Annotated[float, Mark.NULL_IS_INFINITE]
    spots: Annotated[tuple[Spot, ...], JsonEntry(are_rows=True)]
    named: Annotated[tuple[Spot, ...], JsonEntry(keyed_by="x_m")]
    count: Annotated[int, JsonEntry(is_absent=True)] = 0
    weights: Mapping[str, frozenset[int]] = field(default_factory=dict)
    inner: Annotated[Spot | None, JsonEntry(omits_default=True)] = None

    @property
    @derived("length")
    def length_m(self) -> float:
        return self.tip.x_m


class Tree(Struct, kw_only=True):
    """What holds a record that is not its fields."""

    branch: Branch


class Twig(Struct, kw_only=True, tag="twig"):
    """Holds one more twig, or what several twigs hold."""

    next: Twig | Fork | None


class Fork(Struct, kw_only=True, tag="fork"):
    """Several twigs."""

    twigs: tuple[Twig | Fork, ...]


Mixed = str | list["Mixed"]


class Bag(Struct, kw_only=True):
    """Holds a union without a name."""

    value: str | int


class Endless(Struct, kw_only=True):
    """Holds a union that holds itself."""

    value: Mixed


def written(*, is_asked: bool) -> dict[str, str]:
    return words(Leaf, {Leaf} if is_asked else set())


def words(kind: type, asked: set[type]) -> dict[str, str]:
    writer = SCRIPT["_Writer"](asked)
    writer.word(kind)
    return dict(writer.written)


def test_the_committed_types_are_what_make_docs_writes() -> None:
    assert SCRIPT["TYPES"].read_text(encoding="utf-8") == SCRIPT["types_text"](), "run make docs"


def test_a_struct_is_an_interface_with_its_comment_and_an_enum_a_union() -> None:
    assert written(is_asked=False) == {
        "Colour": '/** Of a leaf. */\nexport type Colour = "green" | "red";\n',
        "Leaf": (
            "/**\n * What `grows`.\n *\n * And falls.\n */\n"
            'export interface Leaf {\n  kind: "leaf";\n  colour: Colour | null;\n'
            "  sides_m: (number | null)[];\n  on: [string, number];\n}\n"
        ),
    }


def test_what_a_request_may_leave_out_is_optional() -> None:
    assert "  sides_m?: (number | null)[];\n  on?: [string, number];\n" in written(is_asked=True)["Leaf"]


def test_a_record_is_what_stands_in_its_json() -> None:
    assert words(Branch, set())["Branch"] == (
        "/** What bears leaves. */\nexport interface Branch {\n"
        "  dead: boolean;\n  x_m: number;\n  level: Level | null;\n  rate_hz: number | null;\n"
        "  spots: [x_m: number, level: Level | null][];\n"
        '  named: Record<string, Omit<Spot, "x_m">>;\n'
        "  weights: Record<string, number[]>;\n  inner?: Spot;\n  length: number;\n}\n"
    )
    assert '"low" | "high"' in words(Branch, set())["Level"]


def test_a_struct_holds_no_record_that_msgspec_would_write_otherwise() -> None:
    with pytest.raises(TypeError, match=r"Tree.* holds"):
        words(Tree, set())


def test_types_that_hold_themselves_and_unions_without_a_name_are_written() -> None:
    found = words(Twig, set())
    assert '  type: "twig";\n  next: Twig | Fork | null;\n' in found["Twig"]
    assert "  twigs: (Twig | Fork)[];\n" in found["Fork"]
    assert "  value: string | number;\n" in words(Bag, set())["Bag"]


def test_a_union_that_holds_itself_is_refused() -> None:
    with pytest.raises(TypeError, match="has no word in TypeScript"):
        words(Endless, set())


def test_the_page_calls_every_route_of_the_server() -> None:
    page = "".join(path.read_text(encoding="utf-8") for path in GUI.rglob("*.ts*") if path != SCRIPT["TYPES"])
    routes = re.findall(r'^  "((?:GET|POST|PUT) .*?)":', SCRIPT["types_text"](), re.MULTILINE)
    assert len(routes) > 20
    assert [route for route in routes if f'"{route}"' not in page] == []


@pytest.mark.parametrize("folder", ["gui/src", "gui/tests"])
def test_the_levels_stand_in_no_other_file_of_the_page(folder: str) -> None:
    # Tests of components read them on the screen.
    others = {SCRIPT["TYPES"], *(ROOT / "gui" / "tests" / "page").rglob("*.ts*")}
    files = [path for path in (ROOT / folder).rglob("*.ts*") if path not in others]
    assert [path.name for path in files if '"Competitive"' in path.read_text(encoding="utf-8")] == []
