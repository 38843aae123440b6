# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The session that the thesis shows (figures 6.6, A.2 and A.3), request by request."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ruler.ruler_server import Page, served
from smarttestudo.cli.main import main

SIZES_AND_TIERS = {
    "/cmd_vel": (0.052, [5, 10, 15, 18, 20, 25]),
    "/odom": (0.72, [10, 15, 20, 25, 30, 35]),
    "/camera/camera_info": (0.38, [10, 15, 20, 25, 30, 35]),
    "/camera/image_raw/compressed": (420, [5, 10, 15, 20, 30, 35]),
    "/camera/image_raw": (6220, [2, 5, 10, 15, 20, 25]),
    "/imu": (0.32, [50, 75, 100, 150, 200, 250]),
    "/joint_state": (0.12, [2, 4, 6, 8, 10, 15]),
    "/scan": (2.94, [2, 4, 6, 8, 10, 15]),
    "/tf": (0.17, [2, 10, 20, 30, 40, 45]),
}
DEFAULTS_HZ = (5, 10, 10, 5, 2, 50, 2, 2, 2)


def check(name: str, op: str, value: float) -> dict[str, object]:
    return {"kind": "check", "topic": "/odom", "property": name, "op": op, "value": value}


RULE = {
    "kind": "rule",
    "name": "Shelf",
    "condition": {
        "kind": "and",
        "terms": [
            check("pose_x", ">", 11),
            check("pose_x", "<", 15),
            check("pose_y", ">", 7),
            check("pose_y", "<", 11),
        ],
    },
    "then": [
        {"kind": "set", "topic": "/imu", "rate": {"kind": "tier", "value": "Competitive"}},
        {"kind": "set", "topic": "/camera/image_raw", "rate": {"kind": "tier", "value": "Excessive"}},
    ],
    "else": [],
}


@pytest.fixture
def page(tmp_path: Path) -> Iterator[Page]:
    with served(tmp_path) as page:
        yield page


def written_profile(page: Page, budget_kb_per_s: float) -> str:
    rows = [
        {"topic": topic, "message_kb": size_kb, "tiers_hz": tiers_hz}
        for topic, (size_kb, tiers_hz) in SIZES_AND_TIERS.items()
    ]
    table = {"rows": rows, "budget_kb_per_s": budget_kb_per_s}
    return str(page.post("/api/profile/write", table).json["text"])


def written_rules(page: Page) -> str:
    insert = {"kind": "insert", "collection": "c1", "index": 0, "statement": RULE}
    return str(page.post("/api/edit", {"text": "begin\nend\n", "edits": [insert]}).json["text"])


def rates_hz(situation: Any) -> dict[str, float]:
    return {load["topic"]: load["rate_hz"] for load in situation["loads"]}


def test_the_rule_and_the_table_give_the_numbers_of_the_thesis(
    page: Page, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    request = {"text": written_rules(page), "profile_text": written_profile(page, 275000)}
    answer = page.post("/api/optimize", request).json
    defaults, block, worst = answer["situations"]
    defaults_hz = dict(zip(SIZES_AND_TIERS, DEFAULTS_HZ, strict=True))
    assert rates_hz(defaults) == defaults_hz
    assert rates_hz(block) == {**defaults_hz, "/imu": 200, "/camera/image_raw": 35}
    assert block["kb_per_s"] == worst["kb_per_s"] == pytest.approx(219_881.72)
    download = answer["download_text"]
    statements = page.post("/api/document", {"text": download}).json["collections"][0]["statements"]
    assert {one["topic"]: one["rate"]["value"] for one in statements[:-1]} == defaults_hz
    assert [one["rate"] for one in statements[-1]["then"]] == [
        {"kind": "hz", "value": 200},
        {"kind": "hz", "value": 35},
    ]
    page.put("/api/file", {"name": "shelf.adirf", "text": download, "base_hash": None})
    assert main(["check", str(tmp_path / "shelf.adirf")]) == 0
    capsys.readouterr()


def test_a_weak_link_is_explained_with_repairs_that_fit(page: Page) -> None:
    request = {"text": written_rules(page), "profile_text": written_profile(page, 15000)}
    (refusal,) = page.post("/api/optimize", request).json["refusals"]
    assert refusal["needs_kb_per_s"] == pytest.approx(157_665.72)
    best = refusal["repairs"][0]
    assert "/camera/image_raw Marginal fits with 14 605.72 KB/s" in best["title"]
    edited = page.post("/api/edit", {"text": request["text"], "edits": best["edits"]}).json
    assert page.post("/api/optimize", {**request, "text": edited["text"]}).json["feasible"]
