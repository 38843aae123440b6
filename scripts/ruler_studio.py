# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Where pictures of the Ruler's page are drawn: one page as it is, or a sheet of its widths and themes."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Locator, Page


@dataclass(frozen=True, slots=True, kw_only=True)
class Screen:
    """What somebody looks at: its size in CSS pixels, and whether it is touched."""

    width: int
    height: int
    has_touch: bool = False


SCREENS = (
    Screen(width=1440, height=900),
    Screen(width=1280, height=800),
    Screen(width=820, height=1180, has_touch=True),
    Screen(width=390, height=844, has_touch=True),
)
"""A desk, a laptop, a tablet and a telephone."""
SHRINK = 2
GAP_PX = 12
BEHIND = (128, 134, 140)
SETTLED_MS = 1500
"""After a change of theme blocks, charts and the map are drawn anew."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Studio:
    """A browser, the address of a Ruler, and the folders that pictures, and shots for sheets, go to."""

    browser: Browser
    url: str
    out: Path
    shots: Path

    def open_page(self, *, height: int = 800, width: int = 1280, dark: bool = False) -> Page:
        """A new tab on the home screen of who knows the page."""
        page = self.browser.new_page(
            viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light"
        )
        return self._opened(page)

    def draw(self, shown: Page | Locator, name: str) -> None:
        """Write ``ruler-NAME.png``, or ``ruler.png``, in 256 colours: a third of the bytes."""
        path = self.out / ("-".join(["ruler", name]) if name else "ruler")
        few = picture_of(shown).quantize(256, dither=Image.Dither.NONE)
        few.save(path.with_suffix(".png"), optimize=True)

    def on(self, screen: Screen) -> ScreenStudio:
        """The same on one screen."""
        return ScreenStudio(browser=self.browser, url=self.url, out=self.out, shots=self.shots, screen=screen)

    def _opened(self, page: Page) -> Page:
        page.add_init_script("localStorage.setItem('tour', 'seen')")
        page.goto(self.url)
        return page


@dataclass(frozen=True, slots=True, kw_only=True)
class ScreenStudio(Studio):
    """One with a single screen, on which every page is drawn light and dark for a sheet."""

    screen: Screen

    def open_page(self, *, height: int = 0, width: int = 0, dark: bool = False) -> Page:  # noqa: ARG002
        """A new tab as on the screen, whatever size and theme a picture of its own would have."""
        screen = self.screen
        page = self.browser.new_page(
            viewport={"width": screen.width, "height": screen.height},
            has_touch=screen.has_touch,
            color_scheme="light",
        )
        return self._opened(page)

    def draw(self, shown: Page | Locator, name: str) -> None:
        """Write the two shots, as large as the screen, and close the page."""
        page = shown if isinstance(shown, Page) else shown.page
        for is_dark in (False, True):
            page.emulate_media(color_scheme="dark" if is_dark else "light")
            page.wait_for_timeout(SETTLED_MS)
            picture_of(page).save(self.shots / shot_name(name, self.screen, is_dark=is_dark))
        page.close()


def shot_name(name: str, screen: Screen, *, is_dark: bool) -> str:
    """The file of one shot of a page."""
    return f"{name}-{screen.width}-{'dark' if is_dark else 'light'}.png"


def write_sheet(shots: Path, name: str, path: Path) -> None:
    """Lay out the shots of a page, a row for each theme, at half their size."""
    rows = []
    for is_dark in (False, True):
        pictures = [Image.open(shots / shot_name(name, screen, is_dark=is_dark)) for screen in SCREENS]
        rows.append(side_by_side([picture.reduce(SHRINK) for picture in pictures]))
    sheet = Image.new("RGB", (rows[0].width, 2 * rows[0].height - GAP_PX), BEHIND)
    for number, row in enumerate(rows):
        sheet.paste(row, (0, number * (row.height - GAP_PX)))
    sheet.save(path, quality=60, method=6)


def picture_of(shown: Page | Locator) -> Image.Image:
    """What is seen now, with no movement in it, and nothing below the mouse."""
    page = shown if isinstance(shown, Page) else shown.page
    page.mouse.move(0, 0)
    return Image.open(io.BytesIO(shown.screenshot(animations="disabled"))).convert("RGB")


def side_by_side(pictures: Sequence[Image.Image]) -> Image.Image:
    """A row of pictures with gaps between and around them."""
    width = sum(picture.width + GAP_PX for picture in pictures) + GAP_PX
    height = max(picture.height for picture in pictures) + 2 * GAP_PX
    row = Image.new("RGB", (width, height), BEHIND)
    left = GAP_PX
    for picture in pictures:
        row.paste(picture, (left, GAP_PX))
        left += picture.width + GAP_PX
    return row
