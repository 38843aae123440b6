# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page's types are those of the server's structs.

A field that the server gets is not in the committed file until ``make docs`` writes it. A field that the
server loses is none of the page's types any more, so the page's own type check finds who still reads it.
"""

from __future__ import annotations

import re
import runpy
from enum import Enum
from pathlib import Path

import pytest
from msgspec import Struct

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


def written(*, is_asked: bool) -> dict[str, str]:
    writer = SCRIPT["_Writer"]({Leaf} if is_asked else set())
    writer.word(Leaf)
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


def test_the_page_calls_every_route_of_the_server() -> None:
    page = "".join(path.read_text(encoding="utf-8") for path in GUI.rglob("*.ts*") if path != SCRIPT["TYPES"])
    routes = re.findall(r'^  "((?:GET|POST|PUT) .*?)":', SCRIPT["types_text"](), re.MULTILINE)
    assert len(routes) > 20
    assert [route for route in routes if f'"{route}"' not in page] == []


@pytest.mark.parametrize("folder", ["gui/src", "gui/tests"])
def test_the_levels_stand_in_no_other_file_of_the_page(folder: str) -> None:
    files = [path for path in (ROOT / folder).rglob("*.ts*") if path != SCRIPT["TYPES"]]
    assert [path.name for path in files if '"Competitive"' in path.read_text(encoding="utf-8")] == []
