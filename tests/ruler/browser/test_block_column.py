# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks stand one below the other in the order of the text, and never lie on each other."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from ruler.browser.block_stacks import (
    CANVAS,
    CORNERS,
    GROUND,
    STACKS,
    TEXT_SAYS,
    expect_order,
    gaps,
    stacks,
)
from ruler.browser.ruler_page import GRIP_PX, RulerPage

EDITS = 200
MOST_STATEMENTS = 24
"""Above this many the walk rather removes: from 40 on a part of them is blocks."""


@pytest.mark.journey
def test_new_blocks_stand_below_each_other_in_the_order_of_the_text(ruler: RulerPage) -> None:
    _new_file(ruler)
    for _ in range(5):
        ruler.button("New rate").click()
    for _ in range(2):
        ruler.button("New rule").click()
    ruler.expect_lines("SetFrequency /odom 10", *["SetFrequency /"] * 4, *["CheckValue /odom pose_x > 0"] * 2)
    expect_order(ruler)
    assert gaps(ruler) == pytest.approx([gaps(ruler)[0]] * 2, abs=1)
    assert gaps(ruler)[0] > 0
    ruler.button("New rate").click()
    ruler.type_value("/late")
    ruler.expect_lines("SetFrequency /late 10", "CheckValue")
    expect_order(ruler)
    assert [len(stack["says"]) for stack in stacks(ruler)] == [6, 1, 1]


def test_after_any_edits_no_blocks_meet_and_the_order_is_that_of_the_text(
    ruler: RulerPage,
) -> None:
    _new_file(ruler)
    walk = _Walk(ruler, random.Random(25))
    for number in range(EDITS):
        walk.step()
        if number % 20 == 0:
            _expect_reachable(ruler)
    assert walk.done.keys() == {step.__name__ for step in walk.steps}


class _Walk:
    """Somebody who does this and that with blocks; after each edit the law is looked at."""

    def __init__(self, ruler: RulerPage, chance: random.Random) -> None:
        self.ruler = ruler
        self.chance = chance
        self.done: dict[str, int] = {}
        self.number = 0
        self.steps: list[Callable[[], object]] = [
            self.new_rate,
            self.new_rule,
            self.grow,
            self.grow,
            self.remove,
            self.move,
            self.undo,
            self.redo,
            self.type_text,
            self.recipe,
            self.paste,
            self.drag,
            self.drag,
            self.pull,
            self.fold,
            self.fold,
            self.fold_all,
        ]

    def step(self) -> None:
        step = self.chance.choice(self.steps)
        if len(self.ruler.page.evaluate(f"({TEXT_SAYS})()")) > MOST_STATEMENTS:
            step = self.chance.choice([self.remove, self.undo])
        step()
        self.done[step.__name__] = self.done.get(step.__name__, 0) + 1
        self.ruler.page.keyboard.press("Escape")
        expect_order(self.ruler)

    def topic(self) -> str:
        self.number += 1
        return f"/t{self.number}"

    def new_rate(self) -> None:
        self.ruler.button("New rate").click()
        self.ruler.type_value(self.topic())

    def new_rule(self) -> None:
        self.ruler.button("New rule").click()
        self.ruler.type_value(self.topic())

    def grow(self) -> None:
        self.press(self.chance.choice(["Add check", "Add rate", "Add bound", "Add recording", "Add ELSE"]))

    def remove(self) -> None:
        self.press("Remove this")

    def move(self) -> None:
        self.press(self.chance.choice(["Move this rule up", "Move this rule down", "Duplicate this rule"]))

    def fold(self) -> None:
        """Fold one rule to a line, or unfold it."""
        self.press(self.chance.choice(["Fold this rule", "Unfold "]))

    def fold_all(self) -> None:
        self.ruler.page.mouse.click(*self.ground(), button="right")
        name = self.chance.choice(["Fold all", "Unfold all"])
        self.ruler.page.get_by_role("menuitem", name=name, exact=True).click()

    def ground(self) -> tuple[float, float]:
        """A place beside all blocks."""
        x, y = self.ruler.blocks.locator(".blocks-host").evaluate(GROUND)
        return x, y

    def undo(self) -> None:
        self.press_tool("Undo")

    def redo(self) -> None:
        self.press_tool("Redo")

    def type_text(self) -> None:
        _change_text(self.ruler, "begin", f"begin\n    SetFrequency {self.topic()} 3")

    def recipe(self) -> None:
        page = self.ruler.page
        page.get_by_role("treeitem", name="Recipes").click()
        recipes = page.get_by_role("listbox", name="Recipes blocks").get_by_role("option")
        recipes.first.click(position={"x": GRIP_PX, "y": GRIP_PX})

    def paste(self) -> None:
        if self.focus(f"{CANVAS} > .blocklyDraggable"):
            self.ruler.page.keyboard.press("Control+c")
            self.ruler.page.keyboard.press("Control+v")

    def drag(self) -> None:
        """Drag a stack that can be seen to anywhere."""
        self.drag_one(f"{CANVAS} > .blocklyDraggable > .blocklyPath")

    def pull(self) -> None:
        """Drag anything that can be seen, such as a check or a rate of a rule, to anywhere."""
        self.drag_one(f"{CANVAS} .blocklyDraggable > .blocklyPath")

    def drag_one(self, selector: str) -> None:
        host = self.ruler.blocks.locator(".blocks-host").bounding_box()
        assert host is not None
        bottom = host["y"] + host["height"]
        corners = self.ruler.page.locator(selector).evaluate_all(CORNERS)
        seen = [(x, y) for x, y in corners if host["y"] < y < bottom - 2 * GRIP_PX]
        if not seen:
            return
        left, top = self.chance.choice(seen)
        mouse = self.ruler.page.mouse
        mouse.move(left + GRIP_PX, top + GRIP_PX)
        mouse.down()
        x = host["x"] + self.chance.uniform(200, host["width"] - 40)
        mouse.move(x, self.chance.uniform(host["y"] + 10, bottom - 30), steps=6)
        mouse.up()

    def press(self, label: str) -> None:
        """Press one of the buttons on blocks with this label, wherever it is."""
        if self.focus(f'{CANVAS} [role=button][aria-label^="{label}"]'):
            self.ruler.page.keyboard.press("Enter")

    def focus(self, selector: str) -> bool:
        """Give one of these the focus, in one step: an answer on its way may take away what was counted."""
        pick = "(found, part) => { found[Math.floor(part * found.length)]?.focus(); return found.length > 0 }"
        found: bool = self.ruler.page.locator(selector).evaluate_all(pick, self.chance.random())
        return found

    def press_tool(self, name: str) -> None:
        """Press it where it is enabled, in one step: an answer on its way may disable it."""
        self.ruler.tool(name).evaluate("tool => tool.click()")


def _new_file(ruler: RulerPage) -> None:
    ruler.button("New Rule File").click()
    ruler.page.get_by_label("Name").fill("fresh")
    ruler.button("Create").click()
    expect(ruler.button("New rate")).to_be_enabled()


def _change_text(ruler: RulerPage, line: str, instead: str) -> None:
    """Change the text as another part of the page would, the focus staying where it is."""
    ruler.page.evaluate(
        "([line, instead]) => { const view = document.querySelector('.cm-content').cmTile.view;"
        " const text = view.state.doc.toString(); const from = text.indexOf(line);"
        " view.dispatch({changes: {from, to: from + line.length, insert: instead}}) }",
        [line, instead],
    )


def _expect_reachable(ruler: RulerPage) -> None:
    """The wheel leads to the first block and to the last one."""
    host = ruler.blocks.locator(".blocks-host").bounding_box()
    assert host is not None
    for way, edge in ((-1, "top"), (1, "bottom")) if stacks(ruler) else ():
        ruler.page.mouse.move(host["x"] + host["width"] - 60, host["y"] + 20)
        ruler.page.mouse.wheel(0, way * 20_000)
        ruler.page.wait_for_function(
            f"""([edge, low, high]) => {{
                const ends = ({STACKS})().map(stack => stack[edge]);
                const reached = edge === "top" ? ends[0] : ends.at(-1);
                return low <= reached && reached <= high;
            }}""",
            arg=[edge, host["y"], host["y"] + host["height"]],
        )
