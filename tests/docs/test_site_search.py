# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The search of the site finds what people type, in a real browser, from a folder."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Browser, Page, expect

from docs.test_site import site

__all__ = ["site"]
pytestmark = pytest.mark.full
MOST_PAGES = 20


@pytest.fixture(scope="module")
def page(worker_browser: Browser) -> Iterator[Page]:
    """A page whose errors fail the tests."""
    thrown: list[str] = []
    with worker_browser.new_context() as context:
        page = context.new_page()
        page.on("pageerror", lambda error: thrown.append(str(error)))
        page.on("console", lambda message: thrown.append(message.text) if message.type == "error" else None)
        yield page
    assert thrown == []


def found(site: Path, page: Page, typed: str) -> list[str]:
    """The pages that are found, the best first."""
    page.goto(f"{(site / 'index.html').as_uri()}?{urlencode({'q': typed})}")
    expect(page.locator(".md-search-result__meta")).to_contain_text("matching document")
    return places(site, page)


def places(site: Path, page: Page) -> list[str]:
    results = page.locator("ol.md-search-result__list > li.md-search-result__item").all()
    links = [str(result.locator("a").first.get_attribute("href")) for result in results]
    return [link.partition("?")[0].partition("#")[0].removeprefix(f"{site.as_uri()}/") for link in links]


@pytest.mark.parametrize(
    ("typed", "expected"),
    [
        ("budget", "how-to/budget.html"),
        ("certificates", "how-to/secure-link.html"),
        ("CPU", "concepts/cost.html"),
        ("decisions", "how-to/why-this-rate.html"),
        ("foxglove", "how-to/operators-end.html"),
        ("incidents", "incidents.html"),
        ("joystick", "how-to/send-goals.html"),
        ("KeepWithin", "language.html"),
        ("latched", "live.html"),
        ("levels", "quality-levels.html"),
        ("lifecycle", "live.html"),
        ("link", "link.html"),
        ("outage", "how-to/after-an-outage.html"),
        ("Prometheus", "monitoring.html"),
        ("QoS", "live.html"),
        ("rules", "language.html"),
        ("RViz", "how-to/operators-end.html"),
        ("systemd", "systemd.html"),
        ("throttle", "pacing.html"),
        ("zones", "ruler/zones.html"),
    ],
)
def test_the_page_that_answers_a_word_is_among_the_first_three(
    site: Path, page: Page, typed: str, expected: str
) -> None:
    pages = found(site, page, typed)

    assert expected in pages[:3]
    assert len(pages) <= MOST_PAGES


@pytest.mark.parametrize(
    ("typed", "expected", "within"),
    [
        ("--budget", "how-to/budget.html", 2),
        ("--foxglove", "how-to/operators-end.html", 2),
        ("--catch-up", "how-to/after-an-outage.html", 2),
        ("error: no folder is named to record into: --incidents DIR does", "troubleshooting.html", 2),
        ("unrecognized arguments: --budgt", "troubleshooting.html", 2),
        ("tls:", "how-to/secure-link.html", 2),
        ("link budget Mbit/s not enough", "how-to/budget.html", 2),
        ("dependencies rclpy requirements", "install.html", 2),
        ("how much CPU does it take", "concepts/cost.html", 2),
        ("CPU compared to C++ throttle", "compared.html", 2),
        ("foxglove without ROS", "how-to/operators-end.html", 2),
        ("200 bags", "how-to/many-recordings.html", 3),
        ("radio outage reconnect missed data", "how-to/after-an-outage.html", 2),
        ("certificates users TLS", "how-to/secure-link.html", 2),
        ("topic_tools throttle", "compared.html", 2),
    ],
)
def test_what_people_type_is_answered_by_one_of_the_first_pages(
    site: Path, page: Page, typed: str, expected: str, within: int
) -> None:
    assert expected in found(site, page, typed)[:within]


def test_letter_by_letter_the_search_throws_nothing_and_shows_no_page_for_one_letter(
    site: Path, page: Page
) -> None:
    page.goto((site / "how-to" / "budget.html").as_uri())
    field, said = page.locator("input.md-search__input"), page.locator(".md-search-result__meta")
    field.click()
    field.press_sequentially("b")
    expect(said).to_contain_text("No matching documents")
    field.press_sequentially("andwidth")
    expect(said).to_contain_text("matching documents")
    assert 0 < len(places(site, page)) <= MOST_PAGES


def test_decisions_and_pages_for_contributors_are_not_in_the_index(site: Path) -> None:
    index = json.loads((site / "search" / "search_index.json").read_text(encoding="utf-8"))
    pages = {entry["location"].partition("#")[0] for entry in index["docs"]}

    assert {page for page in pages if page.startswith(("decisions/", "contributors/"))} == set()
    assert not {"benchmarks.html", "releasing.html"} & pages
    assert {"how-to/budget.html", "reference/commands.html", "troubleshooting.html"} <= pages
