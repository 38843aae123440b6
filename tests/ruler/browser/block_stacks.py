# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What stands on the canvas of the blocks, as the page has it at one moment."""

from __future__ import annotations

import itertools
from typing import TypedDict

from playwright.sync_api import TimeoutError as PlaywrightTimeout

from ruler.browser.ruler_page import RulerPage

CANVAS = ".blocklySvg > .blocklyWorkspace > .blocklyBlockCanvas"
STACKS = """() => [...document.querySelectorAll('CANVAS > .blocklyDraggable')].map(root => {
    const edge = element => element.getBoundingClientRect();
    // Blockly moves what has the focus to the front, which is the end of the document.
    const fromAbove = found => [...found].sort((one, other) => edge(one).top - edge(other).top);
    const inner = [...root.querySelectorAll('.blocklyDraggable')];
    const boxes = [root, ...inner].map(block => edge(block.querySelector(':scope > .blocklyPath')));
    const topics = (part, use) => fromAbove(part.querySelectorAll(`[aria-label^="Edit topic to ${use}"]`))
        .map(field => field.getAttribute('aria-label').split(': ')[1]);
    const rule = () => {
        if (root.matches('.adirf_folded')) return root.textContent.match(/if\\s(\\S+)/)?.[1] ?? '?';
        const actions = root.querySelectorAll('.adirf_set, .adirf_within, .adirf_record').length;
        const hasElse = root.querySelector('[aria-label="Remove ELSE"]') !== null;
        const checks = topics(root, 'check');
        return checks.length && actions > (hasElse ? 1 : 0) ? checks[0] : '?';
    };
    const isRule = root.matches('.adirf_rule, .adirf_folded');
    const isDefault = root.matches('.adirf_set, .adirf_within, .adirf_keep');
    return {
        top: Math.min(...boxes.map(({top}) => top)),
        bottom: Math.max(...boxes.map(({bottom}) => bottom)),
        left: Math.min(...boxes.map(({left}) => left)),
        says: isRule ? [rule()] : isDefault ? topics(root, '') : [],
    };
}).sort((one, other) => one.top - other.top)""".replace("CANVAS", CANVAS)
"""What stands on the canvas, from above: its extent on the screen, and the first topic of each statement.

A rule that lacks a part says ``?``: the text has what it said before. A check alone says nothing.
"""
CORNERS = "all => all.map(each => each.getBoundingClientRect()).map(({left, top}) => [left, top])"
# The first place from the right, above the zoom buttons, where nothing but the ground of the blocks is.
GROUND = """host => {
    const { left, right, top, bottom } = host.getBoundingClientRect();
    for (let x = right - 30; x > left; x -= 15)
        for (let y = top + 8; y < bottom - 200; y += 15)
            if (document.elementFromPoint(x, y).matches(".blocklyMainBackground, .blocklySvg")) return [x, y];
    throw new Error("blocks are everywhere");
}"""
TEXT_SAYS = """() => {
    const text = document.querySelector('.cm-content').cmTile.view.state.doc.toString();
    const outside = text.replace(/\\bThen\\b[^]*?EndIf/g, '');
    return [...outside.matchAll(/(?:SetFrequency|KeepAtLeast|KeepWithin) (\\S+)|\\bIf\\b[^/]*(\\S+)/g)]
        .map(([, default_, check]) => default_ ?? check);
}"""
"""The first topic of each statement of the text."""
IS_SETTLED = f"""() => {{
    const stacks = ({STACKS})();
    const gaps = stacks.slice(1).map((stack, index) => stack.top - stacks[index].bottom);
    const [blocks, text] = [stacks.flatMap(({{says}}) => says), ({TEXT_SAYS})()];
    return blocks.length === text.length
        && blocks.every((topic, index) => topic === '?' || topic === text[index])
        && gaps.every(gap => gap > 4 && Math.abs(gap - gaps[0]) < 1)
        && stacks.every(({{left}}) => Math.abs(left - stacks[0].left) < 1);
}}"""


class Stack(TypedDict):
    """Blocks that hang together: their extent on the screen, and the first topic of each statement."""

    top: float
    bottom: float
    left: float
    says: list[str]


def stacks(ruler: RulerPage) -> list[Stack]:
    found: list[Stack] = ruler.page.evaluate(f"({STACKS})()")
    return found


def gaps(ruler: RulerPage) -> list[float]:
    return [below["top"] - above["bottom"] for above, below in itertools.pairwise(stacks(ruler))]


def expect_order(ruler: RulerPage) -> None:
    """The blocks say what the text says, in its order, with the same gaps."""
    try:
        ruler.page.wait_for_function(f"() => ({IS_SETTLED})()")
    except PlaywrightTimeout:
        says = [each for stack in stacks(ruler) for each in stack["says"]]
        assert says == ruler.page.evaluate(f"({TEXT_SAYS})()")
        raise AssertionError(f"the gaps are {gaps(ruler)}") from None
