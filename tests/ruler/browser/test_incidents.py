# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rules recorded, on the page: found, looked at around its moment, saved and deleted."""

from __future__ import annotations

import re
import shutil
from itertools import pairwise
from pathlib import Path
from zipfile import ZipFile

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from ruler.browser.held_child import first_held
from ruler.browser.ruler_page import EDGES, RulerPage
from ruler.incident_projects import (
    ALL_OF_IT,
    COMPRESSED,
    NEAR_MISS,
    add_bad_incidents,
    compressed,
    grey,
    write_camera_incident,
    write_incidents,
)
from smarttestudo.ruler.tries.keep import keep_incident

BRIGHTNESS = """wanted => {
    const image = document.querySelector(".camera img");
    if (!image.complete || !image.naturalWidth) return false;
    const canvas = Object.assign(document.createElement("canvas"), { width: 1, height: 1 });
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0, 1, 1);
    return Math.abs(context.getImageData(0, 0, 1, 1).data[0] - wanted) < 4;
}"""
TIMES = """() => new Promise(done => {
    const slider = document.querySelector(".scrubber-track input");
    const seen = [];
    const look = () => {
        seen.push(Number(slider.value));
        if (seen.length < 90) requestAnimationFrame(look);
        else done(seen);
    };
    look();
})"""
START_S = 8
"""From the window's start to the moment of what ``write_camera_incident`` records."""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A robot that drove 10 m, and two incidents at 5 m."""
    write_incidents(tmp_path / "project")
    return tmp_path / "project"


def _listed(ruler: RulerPage) -> Locator:
    """The rows of all incidents."""
    ruler.page.get_by_role("link", name="Incidents", exact=True).click()
    return ruler.page.get_by_role("table", name="Incidents").get_by_role("row")


def _open(ruler: RulerPage, title: str) -> None:
    _listed(ruler).get_by_role("link", name=title).click()
    ruler.page.get_by_role("slider", name="Time around the moment (s)").wait_for()


def test_all_incidents_are_in_a_list_and_one_that_is_bad_says_why(ruler: RulerPage, project: Path) -> None:
    add_bad_incidents(project)
    rows = _listed(ruler)
    expect(ruler.page.get_by_text("4 incidents, 2 not read yet, 2 that cannot be read")).to_be_visible()
    near_miss = rows.filter(has_text="near miss")
    for words in ("not read", "Far", "3 s before to 2 s after", "nothing", "incidents"):
        expect(near_miss).to_contain_text(words)
    expect(rows.filter(has_text="all of it")).to_contain_text("ended early")
    expect(rows.filter(has_text="newer")).to_contain_text("Cannot be read: version 7")
    cut = rows.filter(has_text="-cut")
    expect(cut).to_contain_text("was it cut or edited?")
    cut.get_by_role("button", name="Delete").click()
    dialog = ruler.page.get_by_role("dialog")
    expect(dialog).to_contain_text("Its record cannot be read, but its messages may still be there")
    dialog.get_by_role("button", name="Delete").click()
    expect(cut).to_have_count(0)
    expect(rows.filter(has_text="near miss")).to_be_visible()


def test_one_shows_why_and_what_happened_around_its_moment(ruler: RulerPage) -> None:
    _open(ruler, "near miss")
    page = ruler.page
    expect(page.get_by_role("heading", name="near miss", level=1)).to_be_visible()
    for words in (
        "The rule Far began to hold at",
        "/odom pose_y was 5.04 m, above 5 m",
        "from 3 s before to 2 s after",
    ):
        expect(page.get_by_role("main")).to_contain_text(words)
    slider = page.get_by_role("slider", name="Time around the moment (s)")
    expect(slider).to_have_attribute("aria-valuetext", "the moment")
    expect(page.get_by_text("The robot is at x 0.0 m, y 5.0 m")).to_be_visible()
    value = page.get_by_role("figure", name="Value of /odom pose_y")
    expect(value.locator("canvas")).to_be_visible()
    expect(value.locator(".threshold-line")).to_be_visible()
    expect(page.get_by_role("img", name=re.compile("^The condition: Holds for 2 s of 5 s"))).to_be_visible()
    edges = page.locator(".scrubber-track, .lane-plot, .lane .u-over").evaluate_all(EDGES)
    assert len(edges) == 4
    assert all(abs(one - other) <= 1 for edge in edges for one, other in zip(edge, edges[0], strict=True))
    slider.press("Home")
    expect(slider).to_have_attribute("aria-valuetext", "3.0 s before")
    expect(page.get_by_text("The robot is at x 0.0 m, y 2.0 m")).to_be_visible()
    ruler.button("To the moment").click()
    expect(slider).to_have_attribute("aria-valuetext", "the moment")
    expect(page.get_by_role("table", name="Topics").get_by_role("row", name="/map_name")).to_contain_text(
        "1 still valid, came 5.0 s before"
    )
    page.get_by_role("link", name="All incidents").click()
    expect(page.get_by_role("row").filter(has_text="near miss")).not_to_contain_text("not read")


def test_the_frame_of_the_camera_is_that_of_the_slider_and_play_goes_round_the_moment(
    ruler: RulerPage, project: Path
) -> None:
    write_camera_incident(project, {"/camera/h264": (COMPRESSED, compressed("h264", b"\0\0\0\1g"))})
    _open(ruler, "seen")
    page = ruler.page
    expect(page.get_by_role("main")).to_contain_text("Because/odom pose_y was 3.12 m, above 3.1 m")
    image = page.locator(".camera").get_by_role("img")
    slider = page.get_by_role("slider", name="Time around the moment (s)")
    for key, frame, alt in (("Home", 0, "3.1 s before, 1 of 50"), ("End", 49, "6.7 s after, 50 of 50")):
        slider.press(key)
        expect(image).to_have_attribute("alt", f"/camera/compressed, {alt}")
        page.wait_for_function(BRIGHTNESS, arg=grey(frame))
    assert violations(page) == []
    ruler.button("To the moment").click()
    ruler.page.get_by_role("combobox", name="Speed").select_option("50")
    ruler.button("Play").click()
    # At 50 times the speed it is round within a fifth of a second.
    seen = page.evaluate(TIMES)
    ruler.button("Pause").click()
    assert min(seen) >= START_S - 5 - 0.1
    assert max(seen) <= START_S + 5 + 0.1
    assert any(later < earlier for earlier, later in pairwise(seen))
    page.get_by_role("combobox", name="Camera").select_option("/camera/h264")
    expect(page.get_by_text("Its frames are h264, not JPEG or PNG")).to_be_visible()
    ruler.forgive("422")


def test_without_the_rules_of_then_the_value_is_there_and_the_threshold_is_not(
    ruler: RulerPage, project: Path
) -> None:
    (project / "far.adirf").unlink()
    _open(ruler, "near miss")
    expect(ruler.page.get_by_text("the thresholds are not known here")).to_be_visible()
    value = ruler.page.get_by_role("figure", name="Value of /odom pose_y")
    expect(value.locator("canvas")).to_be_visible()
    expect(value.locator(".threshold-line")).to_have_count(0)


def test_the_name_of_an_incident_stands_on_one_line_of_a_telephone(ruler: RulerPage) -> None:
    ruler.page.set_viewport_size({"width": 390, "height": 844})
    _open(ruler, "near miss")
    box = ruler.page.get_by_role("heading", name="near miss", level=1).bounding_box()
    assert box is not None
    assert box["height"] < 25


def test_what_is_missing_is_said_with_times(ruler: RulerPage) -> None:
    _open(ruler, "all of it")
    missing = ruler.page.get_by_role("list", name="Missing")
    expect(missing.get_by_role("listitem")).to_have_text(
        "whatever came on /gripper, /map_name, /odom, /scan, from 4.9 s after to 60.0 s after: "
        "the run, or the recording, ended"
    )


def test_the_rule_is_a_click_away_in_the_text(ruler: RulerPage, project: Path) -> None:
    _open(ruler, "near miss")
    ruler.page.get_by_role("link", name="Far in far.adirf").click()
    ruler.blocks.wait_for()
    expect(ruler.text.locator(".spot").first).to_contain_text('Rule "Far"')
    (project / "far.adirf").unlink()
    ruler.home()
    _open(ruler, "near miss")
    expect(ruler.page.get_by_role("main")).to_contain_text("which is not in this project")


def test_a_download_holds_the_same_bytes(ruler: RulerPage, project: Path, tmp_path: Path) -> None:
    _open(ruler, "near miss")
    with ruler.page.expect_download() as waiting:
        ruler.page.get_by_role("link", name="Download").click()
    name = NEAR_MISS.rpartition("/")[2]
    assert waiting.value.suggested_filename == f"{name}.zip"
    waiting.value.save_as(tmp_path / "saved.zip")
    with ZipFile(tmp_path / "saved.zip") as archive:
        assert {one: archive.read(one) for one in archive.namelist()} == {
            f"{name}/{one.name}": one.read_bytes()
            for one in (project / NEAR_MISS).iterdir()
            if one.name != "read"
        }


def test_deleting_asks_first_and_says_what_is_lost(ruler: RulerPage, project: Path) -> None:
    _open(ruler, "near miss")
    ruler.button("Delete").click()
    dialog = ruler.page.get_by_role("dialog", name="Delete this incident?")
    for words in ("near miss", "messages", NEAR_MISS, "cannot be had back"):
        expect(dialog).to_contain_text(words)
    dialog.get_by_role("button", name="Cancel").click()
    assert (project / NEAR_MISS).exists()
    ruler.button("Delete").click()
    dialog.get_by_role("button", name="Delete").click()
    expect(ruler.page.get_by_role("row").filter(has_text="all of it")).to_be_visible()
    expect(ruler.page.get_by_role("row").filter(has_text="near miss")).to_have_count(0)
    assert not (project / NEAR_MISS).exists()
    assert (project / ALL_OF_IT).exists()


def test_messages_that_cannot_be_read_leave_the_rest(ruler: RulerPage, project: Path) -> None:
    for file in (project / NEAR_MISS).glob("*.mcap"):
        file.unlink()
    _listed(ruler).get_by_role("link", name="near miss").click()
    expect(ruler.page.get_by_role("alert")).to_be_visible()
    expect(ruler.page.get_by_role("main")).to_contain_text("/odom pose_y was 5.04 m")
    expect(ruler.page.get_by_role("table", name="Topics")).to_be_visible()
    ruler.forgive("422")


def test_a_try_shows_what_would_have_been_recorded_and_keeps_it(ruler: RulerPage, project: Path) -> None:
    shutil.rmtree(project / "incidents")
    ruler.home()
    ruler.open("far.adirf")
    ruler.open_pane("Try on a recording")
    ruler.button("Run the rules on it").click()
    recorded = ruler.page.get_by_role("region", name="What the rules would have recorded")
    near_miss = recorded.get_by_role("listitem").filter(has_text="near miss")
    for words in ("by Far, 3 s before to 2 s after", "/odom 126 messages", "/gripper 25 messages"):
        expect(near_miss).to_contain_text(words)
    expect(recorded.get_by_role("listitem").filter(has_text="all of it")).to_contain_text(
        "Missing: whatever came on"
    )
    near_miss.get_by_role("button", name="5.0 s", exact=True).click()
    slider = ruler.page.get_by_role("slider", name="Time in the recording (s)")
    expect(slider).to_have_attribute("aria-valuetext", re.compile(r"^5\.0 s"))
    near_miss.get_by_role("button", name="Keep it: near miss").click()
    bar = ruler.page.get_by_role("region", name="Incidents being kept")
    expect(bar).to_contain_text("near miss at 5.0 s of monday")
    # It goes on in the server, and is told of wherever one is.
    ruler.page.reload()
    expect(bar).to_contain_text("near miss at 5.0 s of monday")
    ruler.page.get_by_role("link", name="Rules", exact=True).click()
    bar.get_by_role("link", name=NEAR_MISS).click()
    expect(bar).to_have_count(0)
    expect(ruler.page.get_by_role("main")).to_contain_text("/odom pose_y was 5.04 m")
    assert [one.name for one in (project / "incidents").iterdir()] == [NEAR_MISS.rpartition("/")[2]]


def test_keeping_is_cancelled_on_any_page_and_leaves_nothing(ruler: RulerPage, project: Path) -> None:
    shutil.rmtree(project / "incidents")
    ruler.home()
    ruler.open("far.adirf")
    ruler.open_pane("Try on a recording")
    ruler.button("Run the rules on it").click()
    kept = ruler.page.get_by_role("region", name="What the rules would have recorded")
    bar = ruler.page.get_by_role("region", name="Incidents being kept")
    # The second waits for the first.
    with first_held(keep_incident) as first:
        for name in ("near miss", "all of it"):
            kept.get_by_role("button", name=f"Keep it: {name}").click()
        first()
        ruler.page.get_by_role("link", name="Rules", exact=True).click()
        bar.get_by_role("button", name="Cancel keeping all of it").click()
        expect(bar.get_by_text("all of it")).to_have_count(0)
    expect(bar.get_by_role("link", name=NEAR_MISS)).to_be_visible()
    for width in (1440, 390):
        ruler.page.set_viewport_size({"width": width, "height": 844})
        ruler.page.wait_for_function(f"() => innerWidth === {width}")
        box, home = bar.bounding_box(), ruler.page.get_by_role("main").bounding_box()
        assert box is not None
        assert home is not None
        assert box["y"] + box["height"] <= home["y"] + 1
    bar.get_by_role("button", name="Close: near miss").click()
    expect(bar).to_have_count(0)
    assert [one.name for one in (project / "incidents").iterdir()] == [NEAR_MISS.rpartition("/")[2]]
