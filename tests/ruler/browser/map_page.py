# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The map of the Ruler, pressed and dragged in metres."""

from __future__ import annotations

import re
from dataclasses import dataclass

from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import AFTER_TWO_FRAMES, RulerPage

_PLACE = re.compile(r"x (-?[\d.]+) m, y (-?[\d.]+) m")
_AT_REST = """
() => new Promise(done => {
    let [before, frames] = ["", 0];
    const look = () => {
        const host = document.querySelector(".map-host");
        const scale = document.querySelector(".map-scale");
        const now = [host?.clientWidth, host?.clientHeight, scale?.style.width, scale?.textContent].join();
        frames = now === before ? frames + 1 : 0;
        before = now;
        if (frames >= 10) done();
        else requestAnimationFrame(look);
    };
    look();
})
"""
"""Resolves when the map has had the same size and scale for ten frames."""
_SIDES = ("x from (m)", "x to (m)", "y from (m)", "y to (m)")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Scale:
    """Where the place (0, 0) is on the screen, and pixels per metre."""

    left_px: float
    top_px: float
    px_per_m: float


class MapPage:
    """The Map tab of an open rule file."""

    def __init__(self, ruler: RulerPage) -> None:
        self.ruler = ruler
        ruler.open_pane("Map")
        self.canvas = ruler.page.get_by_role("application", name="Zones on the map")
        self.canvas.wait_for()
        expect(ruler.page.get_by_text("Loading the map …")).to_have_count(0)
        # Zones come with an answer, and all that is there is fitted in anew.
        zones = ruler.page.locator(".zone-list")
        none = zones.get_by_text("No rule depends on the position")
        expect(zones.get_by_role("button").or_(none).first).to_be_visible()
        ruler.page.evaluate(_AT_REST)

    @property
    def form(self) -> Locator:
        """The form of the chosen zone, or of a new one."""
        return self.ruler.page.get_by_role("group", name=re.compile("^(Zone of|New zone)"))

    def sides(self) -> list[str]:
        """The four numbers of the form."""
        return [self.form.get_by_label(label).input_value() for label in _SIDES]

    def place_at(self, x_px: float, y_px: float) -> tuple[float, float]:
        """What the map says of a point of the screen."""
        page = self.ruler.page
        page.mouse.move(x_px, y_px)
        page.evaluate(AFTER_TWO_FRAMES)
        found = _PLACE.search(page.get_by_label("Place of the pointer").text_content() or "")
        assert found
        return float(found[1]), float(found[2])

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Press at one place, in metres, and pull to another."""
        scale, mouse = self._scale(), self.ruler.page.mouse
        mouse.move(*self._pixel(scale, start))
        mouse.down()
        mouse.move(*self._pixel(scale, ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)))
        mouse.move(*self._pixel(scale, end))
        mouse.up()

    def drag_across(self) -> None:
        """Press left of the middle of what is shown and pull to the right of it, wherever that is."""
        box = self.canvas.bounding_box()
        assert box
        mouse = self.ruler.page.mouse
        mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 0.6 * box["height"])
        mouse.down()
        mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
        mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"])
        mouse.up()

    def press(self, *places: tuple[float, float]) -> None:
        scale = self._scale()
        for place in places:
            self.ruler.page.mouse.click(*self._pixel(scale, place))

    def tool(self, name: str) -> None:
        self.ruler.button(name).click()
        expect(self.ruler.button(name)).to_have_attribute("aria-pressed", "true")

    def _scale(self) -> _Scale:
        """Read off at two corners of the map, after it has settled."""
        self.ruler.page.evaluate(_AT_REST)
        box = self.canvas.bounding_box()
        assert box
        left, top = box["x"] + 40, box["y"] + box["height"] - 60
        right, bottom = box["x"] + box["width"] - 80, box["y"] + 90
        (x, y), (far_x, _) = self.place_at(left, top), self.place_at(right, bottom)
        px_per_m = (right - left) / (far_x - x)
        return _Scale(left_px=left - x * px_per_m, top_px=top + y * px_per_m, px_per_m=px_per_m)

    def _pixel(self, scale: _Scale, place: tuple[float, float]) -> tuple[float, float]:
        return scale.left_px + place[0] * scale.px_per_m, scale.top_px - place[1] * scale.px_per_m
