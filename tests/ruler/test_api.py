# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page gets from the server."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from language.written_rules import WrittenFile, written_files
from ruler.ruler_server import EXAMPLES, Page, served

RULE_FILES = sorted(path.relative_to(EXAMPLES).as_posix() for path in EXAMPLES.rglob("*.adirf"))
ZONE = """\
begin
    SetFrequency /odom 10  // the map needs it

    // Loading bay
    Rule "Bay"
    If (
        CheckValue /odom pose_x > 1.0   // the gate
        AND CheckValue /odom pose_x < 2
        AND CheckValue /odom pose_y > 3
        AND CheckValue /odom pose_y < 4
    ) Then
        SetFrequency /odom 4
end
"""
RADIO = (EXAMPLES / "quality" / "radio.toml").read_text(encoding="utf-8")
WEAK_RADIO = (EXAMPLES / "quality" / "weak_radio.toml").read_text(encoding="utf-8")
INSPECTION = (EXAMPLES / "quality" / "inspection.adirf").read_text(encoding="utf-8")


def statements(document: Any) -> list[Any]:
    return [one for collection in document["collections"] for one in collection["statements"]]


@pytest.mark.parametrize("name", RULE_FILES)
def test_every_example_opens_as_blocks_and_saves_byte_identical(
    examples_page: Page, tmp_path: Path, name: str
) -> None:
    text = examples_page.get(f"/api/file?name={quote(name)}").json["text"]
    document = examples_page.post("/api/document", {"text": text, "name": name}).json
    assert document["parses"]
    assert all(one["kind"] != "raw" for one in statements(document))
    for one in statements(document):
        edit = {"kind": "replace", "id": one["id"], "statement": one}
        edited = examples_page.post("/api/edit", {"text": text, "edits": [edit]}).json
        assert edited["text"] == text
    with served(tmp_path) as page:
        assert page.put("/api/file", {"name": "saved.adirf", "text": text, "base_hash": None}).status == 200
    assert (tmp_path / "saved.adirf").read_bytes() == (EXAMPLES / name).read_bytes()


@given(written=written_files(max_statements=3))
@settings(max_examples=25)
def test_a_random_file_comes_back_as_it_was_when_its_statements_are_sent_back(
    examples_page: Page, written: WrittenFile
) -> None:
    document = examples_page.post("/api/document", {"text": written.text}).json
    assert document["parses"]
    for one in statements(document):
        edit = {"kind": "replace", "id": one["id"], "statement": one}
        assert (
            examples_page.post("/api/edit", {"text": written.text, "edits": [edit]}).json["text"]
            == written.text
        )


@given(text=st.text(alphabet='\ufeff\U0001f422é\r\n\t /begindSEftRu123"().', max_size=80))
@settings(max_examples=25)
def test_any_text_is_saved_and_read_byte_by_byte(examples_page: Page, text: str) -> None:
    assert examples_page.post("/api/document", {"text": text}).status == 200


def test_files_keep_their_byte_order_mark_and_line_ends(tmp_path: Path) -> None:
    data = b"\xef\xbb\xbfbegin\r\nSetFrequency /odom 5\r\nend\r"
    (tmp_path / "a.adirf").write_bytes(data)
    with served(tmp_path) as page:
        read = page.get("/api/file?name=a.adirf").json
        page.put("/api/file", {"name": "a.adirf", "text": read["text"], "base_hash": read["hash"]})
        (one,) = statements(page.post("/api/document", {"text": read["text"]}).json)
    assert (tmp_path / "a.adirf").read_bytes() == data
    assert read["text"][one["offset"] : one["end_offset"]] == "SetFrequency /odom 5"


def test_offsets_count_as_javascript_does(examples_page: Page) -> None:
    text = "begin // \U0001f422\U0001f422\nSetFrequency /odom 5 end"
    (one,) = statements(examples_page.post("/api/document", {"text": text}).json)
    units = text.encode("utf-16-le")
    assert units[2 * one["offset"] : 2 * one["end_offset"]].decode("utf-16-le") == "SetFrequency /odom 5"


def test_a_moved_zone_changes_four_numbers_and_nothing_else(examples_page: Page) -> None:
    rule = statements(examples_page.post("/api/document", {"text": ZONE}).json)[1]
    for check, value in zip(rule["condition"]["terms"], (11, 15, 7.5, 11), strict=True):
        check["value"] = value
    edit = {"kind": "replace", "id": rule["id"], "statement": rule}
    text = examples_page.post("/api/edit", {"text": ZONE, "edits": [edit]}).json["text"]
    expected = (
        ZONE.replace("> 1.0 ", "> 11 ").replace("< 2", "< 15").replace("> 3", "> 7.5").replace("< 4", "< 11")
    )
    assert text == expected


def test_a_rule_is_inserted_moved_and_deleted_around_the_others(examples_page: Page) -> None:
    keep = {"kind": "keep", "topic": "/scan", "hz": 2.5, "comments": ["never less"]}
    insert = {"kind": "insert", "collection": "c1", "index": 2, "statement": keep}
    inserted = examples_page.post("/api/edit", {"text": ZONE, "edits": [insert]}).json
    body = ZONE.removesuffix("end\n")
    assert inserted["text"] == f"{body}    EndIf\n\n    // never less\n    KeepAtLeast /scan 2.5\nend\n"
    move = {"kind": "move", "id": "s3", "collection": "c1", "index": 0}
    moved = examples_page.post("/api/edit", {"text": inserted["text"], "edits": [move]}).json
    assert moved["text"].startswith("begin\n    // never less\n    KeepAtLeast /scan 2.5\n    SetFrequency")
    delete = {"kind": "delete", "id": "s1"}
    deleted = examples_page.post("/api/edit", {"text": moved["text"], "edits": [delete]}).json
    assert deleted["text"] == f"{body}    EndIf\nend\n"


@pytest.mark.parametrize(
    "statement",
    [
        {"kind": "set", "topic": "/a 5 SetFrequency /b", "rate": {"kind": "hz", "value": 1}},
        {"kind": "set", "topic": "/a", "rate": {"kind": "hz", "value": -1}},
        {"kind": "set", "topic": "a__b", "rate": {"kind": "full"}},
        {"kind": "keep", "topic": "/a end begin", "hz": 1},
        {"kind": "rule", "name": "a\nb", "condition": {"kind": "and", "terms": []}, "then": [], "else": []},
        {"kind": "rule", "condition": {"kind": "or", "terms": []}, "then": [], "else": []},
    ],
)
def test_what_no_rule_file_can_say_is_refused_with_a_sentence(examples_page: Page, statement: Any) -> None:
    edit = {"kind": "insert", "collection": "c1", "index": 0, "statement": statement}
    answer = examples_page.post("/api/edit", {"text": ZONE, "edits": [edit]})
    assert answer.status == 422
    assert answer.error


def test_two_broken_rules_are_two_raw_statements_with_their_findings_and_the_rest_stays(
    examples_page: Page,
) -> None:
    text = ZONE.replace("SetFrequency /odom 10", "SetFrequncy /odom 10").replace("pose_y > 3", "pose_y => 3")
    text = text.replace("end\n", "    EndIf\n    SetFrequency /imu 5\nend\n")
    document = examples_page.post("/api/document", {"text": text}).json
    assert [one["kind"] for one in statements(document)] == ["raw", "raw", "set"]
    errors = [one for one in document["findings"] if one["severity"] == "error"]
    assert [one["statement"] for one in errors] == ["s1", "s2"]
    for _ in errors:
        document = examples_page.post("/api/document", {"text": text}).json
        fix = next(one["fix"] for one in document["findings"] if one["severity"] == "error")
        text = examples_page.post("/api/edit", {"text": text, "edits": [fix["edit"]]}).json["text"]
    mended = examples_page.post("/api/document", {"text": text}).json
    assert mended["parses"]
    assert [one["kind"] for one in statements(mended)] == ["set", "rule", "set"]


def test_clashing_rules_are_named_in_pairs(examples_page: Page) -> None:
    text = """begin
    SetFrequency /odom 10
    Rule "A" If CheckValue /odom pose_x < 6 Then SetFrequency /odom 4 EndIf
    Rule "B" If CheckValue /odom pose_y < 6 Then SetFrequency /odom 2 EndIf
    end"""
    findings = examples_page.post("/api/document", {"text": text}).json["findings"]
    (clash,) = [one for one in findings if one["code"] == "blocks-clash"]
    assert {clash["statement"], *clash["related"]} == {"s2", "s3"}


def test_formatting_is_that_of_testudo_fmt(examples_page: Page) -> None:
    text = "begin SetFrequency /odom   5 end"
    formatted = examples_page.post("/api/format", {"text": text}).json["text"]
    assert formatted == "begin\n    SetFrequency /odom 5\nend\n"


def test_a_file_that_changed_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    file = tmp_path / "a.adirf"
    file.write_text("begin end")
    with served(tmp_path) as page:
        read = page.get("/api/file?name=a.adirf").json
        file.write_text("begin SetFrequency /odom 5 end")
        answer = page.put("/api/file", {"name": "a.adirf", "text": "mine", "base_hash": read["hash"]})
        new = page.put("/api/file", {"name": "a.adirf", "text": "mine", "base_hash": None})
        missing = page.get("/api/file?name=b.adirf")
        layout = page.put("/api/file", {"name": ".a.adirf.layout.json", "text": "{}", "base_hash": None})
    assert (answer.status, new.status, missing.status, layout.status) == (409, 409, 404, 200)
    assert file.read_text() == "begin SetFrequency /odom 5 end"


def test_a_file_that_changed_is_told_without_its_text(tmp_path: Path) -> None:
    file = tmp_path / "a.adirf"
    file.write_text("begin end")
    with served(tmp_path) as page:
        read = page.get("/api/file?name=a.adirf").json["hash"]
        same = page.get("/api/file/state?name=a.adirf").json
        file.write_text("begin SetFrequency /odom 5 end")
        changed = page.get("/api/file/state?name=a.adirf").json
        file.unlink()
        gone = page.get("/api/file/state?name=a.adirf").json
    assert same == {"hash": read}
    assert changed.keys() == {"hash"}
    assert changed != same
    assert gone == {"hash": None}


def test_the_project_lists_what_the_ruler_can_open(tmp_path: Path) -> None:
    for name in ("a.adirf", "b.toml", "notes.txt", ".hidden.toml", ".a.adirf.layout.json"):
        (tmp_path / name).write_text("")
    (tmp_path / "map.yaml").write_text("image: map.png\nresolution: 0.05\n")
    (tmp_path / "other.yaml").write_text("a: 1\n")
    bag = tmp_path / "bags" / "monday"
    bag.mkdir(parents=True)
    (bag / "metadata.yaml").write_text("x")
    (tmp_path / "bags" / "cut.mcap").write_bytes(b"123")
    with served(tmp_path, opened="a.adirf") as page:
        project = page.get("/api/project").json
    assert project["opened"] == "a.adirf"
    assert [(one["name"], one["kind"]) for one in project["files"]] == [
        (".a.adirf.layout.json", "layout"),
        ("a.adirf", "rules"),
        ("b.toml", "profile"),
        ("bags/cut.mcap", "bag"),
        ("bags/monday", "bag"),
        ("map.yaml", "map"),
    ]


def test_words_are_suggested_from_the_profile_the_rules_and_a_turtlebot(examples_page: Page) -> None:
    profile = '[topics."/robot/odom"]\ntype = "nav_msgs/msg/Odometry"\n'
    text = ZONE.replace("end", "SetFrequency /tb3_0/amcl_pose 1 end")
    answer = examples_page.post("/api/vocabulary", {"text": text, "profile_text": profile}).json
    by_name = {one["topic"]: one for one in answer["topics"]}
    assert by_name["/robot/odom"]["source"] == "profile"
    assert "pose_x" in {one["name"] for one in by_name["/robot/odom"]["properties"]}
    assert (by_name["/odom"]["source"], by_name["/odom"]["type"]) == ("rules", "nav_msgs/msg/Odometry")
    assert "yaw" in {one["name"] for one in by_name["/tb3_0/amcl_pose"]["properties"]}
    assert by_name["/scan"]["source"] == "example"
    assert {one["name"] for one in answer["every_topic"]} == {"rate", "bandwidth", "age"}


def test_words_say_who_uses_a_topic_how_often_it_comes_and_what_its_levels_mean(examples_page: Page) -> None:
    profile = """\
[topics."/odom"]
source_hz = 20
tiers_hz = [1, 2, 5, 10, 15, 20]
tiers_m = [1, 0.5, 0.2, 0.1, 0.05, 0.02]
"""
    answer = examples_page.post("/api/vocabulary", {"text": ZONE, "profile_text": profile}).json
    odom = next(one for one in answer["topics"] if one["topic"] == "/odom")
    assert odom["source_hz"] == 20
    assert odom["levels_hz"] == [[0, 1], [1, 2], [2, 5], [5, 10], [10, 15], [20, 30]]
    assert odom["used_by"] == ["default", "Bay"]
    (position,) = (one for one in odom["bounds"] if one["name"] == "position")
    assert position["levels"] == [[1, 1], [1, 0.5], [0.5, 0.2], [0.2, 0.1], [0.1, 0.05], [0.02, 0.02]]
    assert not any(one["is_published"] for one in answer["topics"])


def test_the_optimizer_says_what_every_situation_takes(examples_page: Page) -> None:
    request = {"text": INSPECTION, "profile_text": RADIO, "profile_name": "radio.toml"}
    answer = examples_page.post("/api/optimize", request).json
    assert answer["feasible"]
    assert [one["kind"] for one in answer["situations"]] == ["defaults", "rule", "worst"]
    assert answer["situations"][1]["rules"] == ["s3"]
    for one in answer["situations"]:
        assert one["kb_per_s"] == pytest.approx(sum(load["kb_per_s"] for load in one["loads"]))
    assert "radio.toml" in answer["download_text"]
    assert not [
        one
        for one in examples_page.post("/api/document", {"text": answer["download_text"]}).json["findings"]
        if one["severity"] == "error"
    ]


def test_what_does_not_fit_is_repaired_by_the_first_edit_offered(examples_page: Page) -> None:
    request = {"text": INSPECTION, "profile_text": WEAK_RADIO}
    answer = examples_page.post("/api/optimize", request).json
    assert (answer["feasible"], answer["download_text"]) == (False, None)
    (refusal,) = answer["refusals"]
    assert refusal["rule"] == "s3"
    edits = {"text": INSPECTION, "edits": refusal["repairs"][0]["edits"]}
    text = examples_page.post("/api/edit", edits).json["text"]
    assert examples_page.post("/api/optimize", {"text": text, "profile_text": WEAK_RADIO}).json["feasible"]
    assert refusal["repairs"][-1]["budget_kb_per_s"] == refusal["needs_kb_per_s"]


ACCURATE = """
budget_kb_per_s = 100
[topics."/a"]
message_kb = 10
tiers_hz = [1, 2, 3, 5, 10, 20]
[topics."/odom"]
message_kb = 0.72
source_hz = 25
tiers_hz = [10, 15, 20, 25, 30, 35]
tiers_m = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]
tiers_m_need_hz = [1, 2, 3, 5, 10, 20]
"""


@pytest.mark.parametrize(("then", "otherwise"), [("Excessive", "Marginal"), ("Marginal", "Excessive")])
def test_a_repair_changes_the_side_of_a_block_that_does_not_fit(
    examples_page: Page, then: str, otherwise: str
) -> None:
    text = f"""begin
    SetFrequency /a Unacceptable
    If (CheckValue /odom pose_x > 1) Then
        SetFrequency /a {then}
        KeepWithin /odom position Desirable
    Else
        SetFrequency /a {otherwise}
        KeepWithin /odom position Desirable
    EndIf
end
"""
    answer = examples_page.post("/api/optimize", {"text": text, "profile_text": ACCURATE}).json
    (refusal,) = answer["refusals"]
    edits = {"text": text, "edits": refusal["repairs"][0]["edits"]}
    mended = examples_page.post("/api/edit", edits).json["text"]
    assert mended == text.replace("Excessive", "Competitive")
    assert examples_page.post("/api/optimize", {"text": mended, "profile_text": ACCURATE}).json["feasible"]


def test_nothing_with_errors_leaves(examples_page: Page) -> None:
    answer = examples_page.post(
        "/api/optimize", {"text": "begin SetFrequency /odom end", "profile_text": RADIO}
    )
    assert answer.status == 409
    assert answer.json["error"]["findings"][0]["code"] == "expected-rate"


def test_edits_of_a_list_are_done_in_their_order_each_in_the_text_of_those_before(
    examples_page: Page,
) -> None:
    keep = {"kind": "keep", "topic": "/scan", "hz": 2.5}
    edits: list[dict[str, Any]] = [
        {"kind": "insert", "collection": "c1", "index": 0, "statement": keep},
        {"kind": "move", "id": "s1", "collection": "c1", "index": 1},
        {"kind": "delete", "id": "s1"},
    ]
    text, documents = ZONE, []
    for edit in edits:
        answer = examples_page.post("/api/edit", {"text": text, "edits": [edit]}).json
        text = answer["text"]
        documents.append(answer["document"])
    assert [one["kind"] for one in statements(documents[-1])] == ["keep", "rule"]
    assert examples_page.post("/api/edit", {"text": ZONE, "edits": edits}).json == {
        "text": text,
        "document": documents[-1],
    }


def test_of_a_list_with_a_refused_edit_none_is_done(examples_page: Page) -> None:
    edits = [{"kind": "delete", "id": "s1"}, {"kind": "delete", "id": "s9"}]
    answer = examples_page.post("/api/edit", {"text": ZONE, "edits": edits})
    assert (answer.status, answer.error) == (422, "the text has no statement 's9'")


@pytest.mark.parametrize(
    ("text", "word", "written"),
    [
        ("// 🐢🐢\nbegin\nend\n", "begin", "// 🐢🐢\nbegin //\nend\n"),
        ("// a 🐢 b\n", "🐢", "// a begin // b\n"),
    ],
)
def test_places_of_a_substitute_count_as_javascript_does(
    examples_page: Page, text: str, word: str, written: str
) -> None:
    start = len(text[: text.index(word)].encode("utf-16-le")) // 2
    end = start + len(word.encode("utf-16-le")) // 2
    edit = {"kind": "substitute", "offset": start, "end_offset": end, "replacement": "begin //"}
    assert examples_page.post("/api/edit", {"text": text, "edits": [edit]}).json["text"] == written


@pytest.mark.parametrize(("offset", "end_offset"), [(-1, 0), (3, 2), (0, 10_000)])
def test_a_substitute_outside_the_text_is_refused(examples_page: Page, offset: int, end_offset: int) -> None:
    edit = {"kind": "substitute", "offset": offset, "end_offset": end_offset, "replacement": ""}
    answer = examples_page.post("/api/edit", {"text": ZONE, "edits": [edit]})
    assert (answer.status, answer.error) == (422, "the text has no such place")
