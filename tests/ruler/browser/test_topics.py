# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The table of the thesis's Figure A.2 goes in, the rates of Figure A.3 come out."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage
from ruler.browser.thesis import DEFAULT_RATES, enter_table

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Route

RULES = """\
begin
    Rule "Shelf"
    If (
        CheckValue /odom pose_x > 11
        AND CheckValue /odom pose_x < 15
        AND CheckValue /odom pose_y > 7
        AND CheckValue /odom pose_y < 11
    )
    Then
        SetFrequency /imu Competitive
        SetFrequency /camera/image_raw {level}
    EndIf
end
"""
FITS = re.compile("^Everything fits into")
"""A text that is no pattern is found in any case: ``Not everything fits into`` has it, too."""
BLOCK_RATES = ("SetFrequency /imu 200", "SetFrequency /camera/image_raw 35")


def test_the_table_of_the_thesis_gives_its_rates(ruler: RulerPage, project: Path, tmp_path: Path) -> None:
    enter_table(ruler, "275000", project)
    (project / "shelf.adirf").write_text(RULES.format(level="Excessive"))
    ruler.home()
    ruler.open("shelf.adirf")
    ruler.tool("Optimize and Download").click()
    expect(ruler.page.get_by_text("Everything fits into 275 000 KB/s")).to_be_visible()
    expect(ruler.page.get_by_text("219 881.72 KB/s").first).to_be_visible()
    with ruler.page.expect_download() as waiting:
        ruler.button("Download rates").click()
    downloaded = tmp_path / waiting.value.suggested_filename
    waiting.value.save_as(downloaded)
    text = downloaded.read_text()
    for topic, rate_hz in DEFAULT_RATES.items():
        assert f"SetFrequency {topic} {rate_hz} Hz\n" in text
    for line in BLOCK_RATES:
        assert line in text
    check = [sys.executable, "-m", "smarttestudo", "check", str(downloaded)]
    assert subprocess.run(check, check=False).returncode == 0


def test_what_does_not_fit_is_explained_and_mended_with_one_click(ruler: RulerPage, project: Path) -> None:
    enter_table(ruler, "15000", project)
    (project / "shelf.adirf").write_text(RULES.format(level="Excessive"))
    ruler.home()
    ruler.open("shelf.adirf")
    ruler.tool("Optimize and Download").click()
    expect(ruler.page.get_by_role("alert")).to_contain_text(re.compile(r"needs at least 157\s665\.72 KB/s"))
    expect(ruler.button("Download rates")).to_be_disabled()
    ruler.page.get_by_role("alert").get_by_role("button").first.click()
    expect(ruler.page.get_by_text(FITS)).to_be_visible()
    expect(ruler.button("Download rates")).to_be_enabled()


def test_rates_of_other_topic_parameters_are_not_downloaded(ruler: RulerPage, project: Path) -> None:
    (project / "two.adirf").write_text("begin\n    SetFrequency /imu 2\nend\n")
    for budget in (100, 200):
        text = f'budget_kb_per_s = {budget}\n[topics."/imu"]\nmessage_kb = 1\n'
        (project / f"{budget}.toml").write_text(text)
    ruler.home()
    ruler.open("two.adirf")
    choice = ruler.page.get_by_label("Topic parameters")
    choice.select_option("100.toml")
    ruler.tool("Optimize and Download").click()
    ruler.page.get_by_text("Everything fits into 100 KB/s").wait_for()
    held: list[Route] = []
    ruler.page.route("**/api/optimize", lambda route: held.append(route), times=1)  # noqa: PLW0108 - no builtin
    with ruler.page.expect_request("**/api/optimize"):
        choice.select_option("200.toml")
    expect(ruler.button("Download rates")).to_be_disabled()
    held.pop().continue_()
    ruler.page.get_by_text("Everything fits into 200 KB/s").wait_for()
    expect(ruler.button("Download rates")).to_be_enabled()


def test_a_rule_file_opens_with_the_topic_parameters_that_fit_it_or_were_chosen_for_it(
    ruler: RulerPage, project: Path
) -> None:
    (project / "shelf.adirf").write_text(RULES.format(level="Excessive"))
    entry = '[topics."{}"]\nmessage_kb = 1\ntiers_hz = [1, 2, 3, 4, 5, 6]\n'
    for name, topics in {"arm": ["/joints"], "base": ["/imu", "/camera/image_raw"]}.items():
        text = "budget_kb_per_s = 100\n" + "".join(entry.format(topic) for topic in topics)
        (project / f"{name}.toml").write_text(text)
    ruler.home()
    ruler.open("shelf.adirf")
    choice = ruler.page.get_by_role("combobox", name="Topic parameters")
    expect(choice).to_have_value("base.toml")

    with ruler.page.expect_response("**/api/profile/for"):
        choice.select_option("arm.toml")
    ruler.tool("Optimize and Download").click()
    refused = ruler.page.get_by_text("/imu is in the rules but not in the chosen profile")
    expect(refused).to_contain_text("Add a row for /imu to its table")
    ruler.complaints.clear()
    ruler.home()
    ruler.open("shelf.adirf")
    expect(choice).to_have_value("arm.toml")
    with ruler.page.expect_response("**/api/profile/for"):
        choice.select_option("none")
    ruler.home()
    ruler.open("shelf.adirf")
    expect(choice).to_have_value("")
    ruler.page.get_by_role("link", name="Create").click()
    expect(ruler.page.get_by_text("shelf.toml, new, not saved")).to_be_visible()


def test_chosen_topic_parameters_are_those_of_everybody_and_named_when_they_are_gone(
    browser: Browser, ruler: RulerPage, project: Path
) -> None:
    (project / "shelf.adirf").write_text(RULES.format(level="Excessive"))
    (project / "mine.toml").write_text('[topics."/imu"]\nmessage_kb = 1\n')
    ruler.home()
    ruler.open("shelf.adirf")
    with ruler.page.expect_response("**/api/profile/for"):
        ruler.page.get_by_label("Topic parameters").select_option("mine.toml")
    with browser.new_context() as elsewhere:
        other = RulerPage(elsewhere.new_page(), ruler.url)
        other.home()
        other.open("shelf.adirf")
        choice = other.page.get_by_label("Topic parameters")
        expect(choice).to_have_value("mine.toml")
        (project / "mine.toml").unlink()
        other.home()
        other.open("shelf.adirf")
        expect(other.page.get_by_role("status").filter(has_text="mine.toml is gone")).to_be_visible()
        expect(choice).not_to_have_value("mine.toml")
        choice.select_option("none")
        expect(other.page.get_by_text("mine.toml is gone")).to_have_count(0)
        assert other.complaints == []


def test_a_reduction_of_very_many_topics_stays_on_the_page(ruler: RulerPage, project: Path) -> None:
    topics = [f"/robot/sensors/number_{number:02}/measurements" for number in range(60)]
    entry = '[topics."{}"]\nmessage_kb = 10\ntiers_hz = [1, 2, 5, 10, 20, 50]\n'
    (project / "many.toml").write_text("budget_kb_per_s = 700\n" + "".join(map(entry.format, topics)))
    (project / "many.adirf").write_text(
        "begin\n" + "".join(f"    SetFrequency {topic} Competitive\n" for topic in topics) + "end\n"
    )
    ruler.page.set_viewport_size({"width": 1280, "height": 800})
    ruler.home()
    ruler.open("many.adirf")
    ruler.tool("Optimize and Download").click()
    repair = ruler.page.get_by_role("alert").get_by_role("button").first
    repair.scroll_into_view_if_needed()
    box = repair.bounding_box()
    assert box is not None
    assert box["x"] + box["width"] <= 1280
    assert box["height"] < 200
    width = "document.querySelector('[role=tabpanel]').scrollWidth"
    assert ruler.page.evaluate(width) <= 1280
    repair.click()
    expect(ruler.page.get_by_text(FITS)).to_be_visible()


def test_all_that_does_not_fit_is_repaired_at_once(ruler: RulerPage, project: Path) -> None:
    entry = '[topics."/{}"]\nmessage_kb = 10\ntiers_hz = [1, 2, 5, 10, 20, 50]\n'
    (project / "two.toml").write_text("budget_kb_per_s = 120\n" + entry.format("odom") + entry.format("scan"))
    rules = "begin\n    SetFrequency /odom Competitive\n    SetFrequency /scan Marginal\n"
    for number in (1, 2):
        rules += (
            f'    Rule "{number}" If CheckValue /odom pose_x > {number}0 Then SetFrequency /scan Excessive\n'
        )
    (project / "two.adirf").write_text(rules + "end\n")
    ruler.home()
    ruler.open("two.adirf")
    ruler.tool("Optimize and Download").click()
    expect(ruler.page.get_by_text("Not everything fits into")).to_be_visible()
    ruler.button("Repair all 2").click()
    expect(ruler.page.get_by_text(FITS)).to_be_visible()
    ruler.tool("Undo").click()
    expect(ruler.page.get_by_text("Not everything fits into")).to_be_visible()


def test_an_empty_file_says_what_to_do_first_and_no_button_is_coloured(
    ruler: RulerPage, project: Path
) -> None:
    (project / "new.adirf").write_text("begin\nend\n")
    ruler.home()
    ruler.open("new.adirf")
    expect(ruler.page.get_by_text("Begin with New rate")).to_be_visible()
    expect(ruler.page.locator("button.primary:visible")).to_have_count(0)
    ruler.button("New rate").click()
    expect(ruler.page.locator("button.primary:visible")).to_have_count(1)


def test_the_table_starts_with_the_topics_of_the_rules_and_leads_back(
    ruler: RulerPage, project: Path
) -> None:
    (project / "aisle.adirf").write_text("begin\n    SetFrequency /lift 5\n    SetFrequency /fork 2\nend\n")
    ruler.home()
    ruler.open("aisle.adirf")
    page = ruler.page
    page.get_by_label("Topic parameters").select_option("none")
    page.get_by_role("link", name="Create").click()
    expect(page.get_by_label("Topic of row 1")).to_have_value("/fork")
    expect(page.get_by_label("Topic of row 2")).to_have_value("/lift")
    expect(page.get_by_text("aisle.toml, new, not saved")).to_be_visible()
    page.get_by_role("button", name="Remove /lift").click()
    expect(page.get_by_text("1 topic of the rules is not in the table.")).to_be_visible()
    ruler.button("Add /lift").click()
    expect(page.get_by_label("Topic of row 2")).to_have_value("/lift")
    page.get_by_label("Message size (KB) of /lift").fill("0.5")
    # Once the table is saved it becomes that of the rules, for which none was chosen above.
    with page.expect_response("**/api/profile/for"):
        ruler.save()
    page.get_by_role("link", name="Back to aisle.adirf").click()
    expect(page.get_by_label("Topic parameters")).to_have_value("aisle.toml")
    ruler.expect_lines("SetFrequency /lift 5")


def test_from_the_first_screen_a_new_table_is_for_the_only_rules(ruler: RulerPage, project: Path) -> None:
    for each in (*project.rglob("*.adirf"), *project.rglob("*.toml")):
        each.unlink()
    (project / "aisle.adirf").write_text("begin\n    SetFrequency /lift 5\nend\n")
    ruler.home()
    ruler.button("Configure Topic Parameters").click()
    expect(ruler.page.get_by_label("Topic of row 1")).to_have_value("/lift")
    expect(ruler.page.get_by_text("aisle.toml, new, not saved")).to_be_visible()
    expect(ruler.page.get_by_role("link", name="Back to aisle.adirf")).to_be_visible()
    # Nobody changed anything yet: nothing is restored, and the table can be saved as it is.
    ruler.page.reload()
    expect(ruler.page.get_by_label("Topic of row 1")).to_have_value("/lift")
    expect(ruler.page.get_by_text("unsaved changes")).to_have_count(0)
    ruler.save()
    assert "/lift" in (project / "aisle.toml").read_text(encoding="utf-8")
