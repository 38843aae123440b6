# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The search of the site finds what people type, in a real browser, from a folder."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Browser, Page, expect

from docs.test_site import site

__all__ = ["site"]
pytestmark = pytest.mark.full


@pytest.fixture(scope="module")
def page(worker_browser: Browser) -> Iterator[Page]:
    with worker_browser.new_context() as context:
        yield context.new_page()


@pytest.mark.parametrize(
    ("typed", "found", "within"),
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
    site: Path, page: Page, typed: str, found: str, within: int
) -> None:
    page.goto(f"{(site / 'index.html').as_uri()}?{urlencode({'q': typed})}")
    expect(page.locator(".md-search-result__meta")).to_contain_text("matching document")
    results = page.locator("ol.md-search-result__list > li.md-search-result__item").all()[:within]
    links = [str(result.locator("a").first.get_attribute("href")) for result in results]
    places = [link.partition("?")[0].partition("#")[0].removeprefix(f"{site.as_uri()}/") for link in links]
    assert found in places
