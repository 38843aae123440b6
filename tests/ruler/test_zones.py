# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page learns about zones, and how its map edits a rule file."""

from __future__ import annotations

from typing import Any

import pytest

from ruler.ruler_server import EXAMPLES, Answer, Page

WAREHOUSE = (EXAMPLES / "warehouse.adirf").read_text(encoding="utf-8")
BOX = {"min_x_m": 1, "max_x_m": 2.5, "min_y_m": 3, "max_y_m": 4}


def rule(name: str, condition: str, rates: str = "SetFrequency /odom 4", *, priority: str = "") -> str:
    return f'Rule "{name}" {priority} If ({condition}) Then {rates} EndIf'


def rules_of(*rules: str) -> str:
    return "\n  ".join(("begin", "SetFrequency /odom 10", *rules)) + "\nend\n"


def x_and_y(low: float, high: float) -> str:
    signs = (("x", ">", low), ("x", "<", high), ("y", ">", low), ("y", "<", high))
    return " AND ".join(f"CheckValue /odom pose_{axis} {sign} {value}" for axis, sign, value in signs)


def zones(page: Page, text: str) -> Any:
    return page.post("/api/zones", {"text": text}).json


def edit(page: Page, text: str, **change: Any) -> Answer:
    return page.post("/api/edit", {"text": text, "edits": [change]})


def test_the_zones_of_the_demo_are_its_corridor_and_its_scaffolding(examples_page: Page) -> None:
    found = zones(examples_page, WAREHOUSE)
    assert [(rule["label"], [zone["rectangle"] for zone in rule["zones"]]) for rule in found["rules"]] == [
        ("Warehouse Corridor", [{"min_x_m": -13, "max_x_m": 6, "min_y_m": 1, "max_y_m": 5.4}]),
        ("Scaffolding", [{"min_x_m": -13, "max_x_m": 6, "min_y_m": 6, "max_y_m": 25.5}]),
    ]
    assert (found["clashes"], found["label"]) == ([], "Zone 1")


@pytest.mark.parametrize(
    ("topic", "x", "y"),
    [
        ("/amcl_pose", "pose_x", "pose_y"),
        ("/amcl_pose", "pose.pose.position.x", "pose.pose.position.y"),
        ("/goal_pose", "pose.position.x", "pose.position.y"),
    ],
)
def test_a_pose_on_the_map_has_zones_as_odometry_has(examples_page: Page, topic: str, x: str, y: str) -> None:
    sides = ((x, ">", 1), (x, "<", 2.5), (y, ">", 3), (y, "<", 4))
    condition = " AND ".join(f"CheckValue {topic} {name} {sign} {value}" for name, sign, value in sides)
    text = rules_of(rule("A", condition))
    (found,) = zones(examples_page, text)["rules"]
    assert [(zone["topic"], zone["rectangle"]) for zone in found["zones"]] == [(topic, BOX)]
    moved = edit(examples_page, text, kind="zone_move", id="s2", topic=topic, dx=1, dy=0).json["text"]
    assert f"CheckValue {topic} {x} > 2 AND CheckValue {topic} {x} < 3.5" in moved


def test_what_a_rule_asks_beside_its_zone_is_told_with_it(examples_page: Page) -> None:
    text = rules_of(
        rule("A", f"{x_and_y(1, 2)} AND CheckValue /battery_state level < 20"),
        rule("B", f"({x_and_y(1, 2)}) OR CheckValue /battery_state level < 20"),
        rule("C", "CheckValue /scan distance < 1"),
    )
    first, second, third = zones(examples_page, text)["rules"]
    assert (first["others"], first["holds_elsewhere"]) == (["/battery_state level < 20"], False)
    assert (len(second["zones"]), second["holds_elsewhere"]) == (1, True)
    assert (third["zones"], third["holds_elsewhere"]) == ([], True)


def test_zones_clash_where_the_checker_says_so_and_nowhere_else(examples_page: Page) -> None:
    far = rule("B", x_and_y(3, 9), "SetFrequency /odom 5")
    (clash,) = zones(examples_page, rules_of(rule("A", x_and_y(0, 4)), far))["clashes"]
    assert clash["common"] == [{"min_x_m": 3, "max_x_m": 4, "min_y_m": 3, "max_y_m": 4}]
    assert clash["message"].startswith('"B" sets /odom to 5 Hz, "A" (line 3) to 4 Hz')
    higher = rule("A", x_and_y(0, 4), priority="Priority 2")
    assert zones(examples_page, rules_of(higher, far))["clashes"] == []
    outside = rule("A", x_and_y(0, 4), "SetFrequency /odom 5 Else SetFrequency /odom 4")
    assert zones(examples_page, rules_of(outside, far))["clashes"] == []


def test_a_text_with_an_error_still_shows_the_zones_that_can_be_read(examples_page: Page) -> None:
    text = WAREHOUSE.replace("pose_y < 25.5", "pose_y <")
    assert [rule["label"] for rule in zones(examples_page, text)["rules"]] == ["Warehouse Corridor"]


def test_the_zone_of_a_rule_that_is_switched_off_says_so(examples_page: Page) -> None:
    text = WAREHOUSE.replace('Rule "Scaffolding"', 'Disabled Rule "Scaffolding"')
    labels = [rule["label"] for rule in zones(examples_page, text)["rules"]]
    assert labels == ["Warehouse Corridor", "Scaffolding (switched off)"]


def test_a_condition_of_too_many_places_is_called_so(examples_page: Page) -> None:
    either = "(CheckValue /odom pose_x > 1 OR CheckValue /odom pose_y > 1)"
    text = f"begin If ({' AND '.join([either] * 7)}) Then SetFrequency /odom 1 EndIf end"
    (found,) = zones(examples_page, text)["rules"]
    assert (found["is_too_mixed"], found["zones"]) == (True, [])


def test_a_new_zone_is_a_rule_at_the_end_and_nothing_else_changes(examples_page: Page) -> None:
    made = edit(
        examples_page, WAREHOUSE, kind="zone_new", topic="/odom", rectangles=[BOX], label="Zone 1"
    ).json
    assert made["text"] == WAREHOUSE.removesuffix("end\n") + (
        '\n    Rule "Zone 1"\n    If (\n'
        "        CheckValue /odom pose_x > 1\n        AND CheckValue /odom pose_x < 2.5\n"
        "        AND CheckValue /odom pose_y > 3\n        AND CheckValue /odom pose_y < 4\n"
        "    )\n    Then\n        SetFrequency /odom Full\n    EndIf\nend\n"
    )
    assert zones(examples_page, made["text"])["rules"][-1]["label"] == "Zone 1"


def test_the_rule_of_a_new_zone_sets_the_topic_that_it_reads_where_that_has_a_default(
    examples_page: Page,
) -> None:
    text = "begin\n  SetFrequency /scan 5\n  SetFrequency /odom 4\nend\n"
    for topic, said in (("/odom", "/odom 10"), ("/amcl_pose", "/scan 10")):
        made = edit(examples_page, text, kind="zone_new", topic=topic, rectangles=[BOX], label="Zone 1").json
        assert f"SetFrequency {said}\n" in made["text"].split("Then")[1]


def test_a_zone_goes_into_a_rule_as_only_there_or_as_there_too(examples_page: Page) -> None:
    text = f"begin\n  {rule('A', 'CheckValue /battery_state level < 20')}\nend\n"
    only = edit(examples_page, text, kind="zone_new", topic="/odom", rectangles=[BOX], into="s1").json["text"]
    (found,) = zones(examples_page, only)["rules"]
    assert (found["others"], found["holds_elsewhere"]) == (["/battery_state level < 20"], False)
    refused = edit(examples_page, only, kind="zone_new", topic="/odom", rectangles=[BOX], into="s1")
    assert (refused.status, refused.error) == (422, '"A" has a zone and other checks')
    corridor = zones(examples_page, WAREHOUSE)["rules"][0]["id"]
    there_too = edit(
        examples_page, WAREHOUSE, kind="zone_new", topic="/odom", rectangles=[BOX], into=corridor
    )
    assert len(zones(examples_page, there_too.json["text"])["rules"][0]["zones"]) == 2


def test_an_open_side_is_closed_by_a_check_of_its_own(examples_page: Page) -> None:
    text = "begin\n  If CheckValue /odom pose_x > 1.50 Then SetFrequency /odom 4 EndIf // hall\nend\n"
    sides = {"min_x_m": 1.5, "max_x_m": 9, "min_y_m": None, "max_y_m": None}
    closed = edit(examples_page, text, kind="zone_resize", id="s1", index=0, rectangle=sides).json["text"]
    assert "CheckValue /odom pose_x > 1.50 AND CheckValue /odom pose_x < 9" in closed
    assert closed.endswith("// hall\nend\n")


@pytest.mark.parametrize(
    ("sides", "cause"),
    [
        ({**BOX, "max_x_m": 1}, "this rectangle has no area"),
        ({**BOX, "min_x_m": None}, "a side cannot be left out here"),
        ({**BOX, "max_y_m": 1e9}, "1000000000.0 m is no place on a map"),
        ({**BOX, "min_x_m": -3}, "another check of the rule bounds this zone too"),
    ],
)
def test_sides_that_a_rule_cannot_have_are_refused_with_a_remedy(
    examples_page: Page, sides: dict[str, Any], cause: str
) -> None:
    text = rules_of(rule("A", f"{x_and_y(0, 4)} AND CheckValue /odom pose_x > -1"))
    answer = edit(examples_page, text, kind="zone_resize", id="s2", index=0, rectangle=sides)
    assert (answer.status, answer.error) == (422, cause)
    assert answer.json["error"]["remedy"]


def test_an_edit_of_a_zone_that_is_not_there_is_refused(examples_page: Page) -> None:
    for change in (
        {"kind": "zone_move", "id": "s1", "topic": "/odom", "dx": 1, "dy": 1},
        {"kind": "zone_resize", "id": "s99", "index": 0, "rectangle": BOX},
        {"kind": "zone_resize", "id": "s10", "index": 7, "rectangle": BOX},
        {"kind": "zone_new", "topic": "/odom 5 SetFrequency /x", "rectangles": [BOX]},
        {"kind": "zone_new", "topic": "/odom", "rectangles": []},
    ):
        assert edit(examples_page, WAREHOUSE, **change).status == 422


def test_a_polygon_is_covered_and_what_that_adds_is_said(examples_page: Page) -> None:
    corners = [[0, 0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]]
    cover = examples_page.post("/api/zones/cover", {"corners": corners}).json
    assert (len(cover["rectangles"]), cover["polygon_m2"], cover["over_m2"]) == (2, 12, 0)
    for bad in ({"corners": corners[:2]}, {"corners": corners, "max_rectangles": 0}):
        assert examples_page.post("/api/zones/cover", bad).status == 422
    assert examples_page.post("/api/zones/cover", {"corners": [[0, 1e400]]}).status in (400, 422)
