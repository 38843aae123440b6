# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The accessibility checker axe-core, as it is installed for the Ruler's page, on any page that is open."""

from __future__ import annotations

import os
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from playwright.sync_api import Page

AXE = Path(__file__).parents[1] / "gui" / "node_modules" / "axe-core" / "axe.min.js"
WIDTHS_PX = (1280, 820, 390)
"""A laptop, a tablet and a telephone."""
HEIGHT_PX = 900
SCHEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")
SWEEPS = tuple(product(SCHEMES, WIDTHS_PX))
if os.environ.get("SWEEPS") == "some":
    SWEEPS = (("light", WIDTHS_PX[0]), ("dark", WIDTHS_PX[-1]))
"""On what a page is looked at; continuous integration looks at all."""
# The size of what is pressed, 24 px or as much space around it, is of WCAG 2.2: axe-core asks for it if told.
RUN = """async (only) => {
    const options = {resultTypes: ["violations"], rules: {"target-size": {enabled: true}}};
    if (only !== null) options.runOnly = {type: "rule", values: only};
    return (await axe.run(document, options)).violations.flatMap(({id, nodes}) => nodes.map(
        (node) => `${id}: ${node.target} ${node.html.slice(0, 120)} ${node.failureSummary}`
    ));
}"""
# All else that axe-core looks at is the same in both schemes.
OF_COLOURS = ["color-contrast", "link-in-text-block"]
# Colours change at once, so that none is measured half way.
HOLD_STILL = """() => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync("*, *::before, *::after { transition: none !important; animation: none !important }");
    document.adoptedStyleSheets.push(sheet);
}"""
# The page follows the scheme with the first.
TWO_PICTURES = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"


def violations(page: Page) -> list[str]:
    """What axe-core reports, in all ``SWEEPS``; the page is as wide as before after it."""
    before = page.viewport_size
    page.evaluate(AXE.read_text("utf-8"))
    page.evaluate(HOLD_STILL)
    found: list[str] = []
    looked_at: set[int] = set()
    for scheme, width in SWEEPS:
        page.emulate_media(color_scheme=scheme)
        page.set_viewport_size({"width": width, "height": HEIGHT_PX})
        page.evaluate(TWO_PICTURES)
        only = OF_COLOURS if width in looked_at else None
        looked_at.add(width)
        found += [f"{scheme}, {width} px: {each}" for each in page.evaluate(RUN, only)]
    page.emulate_media(color_scheme="light")
    if before is not None:
        page.set_viewport_size(before)
    return found
