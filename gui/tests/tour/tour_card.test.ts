// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { type Box, placed, shownPart } from "../../src/tour/tour_page";

const CARD = { width: 390, height: 220 };
const DESK = { width: 1280, height: 800 };
const PARTS: Record<string, Box> = {
  blocks: { left: 0, top: 52, width: 742, height: 490 },
  text: { left: 747, top: 52, width: 533, height: 490 },
  results: { left: 0, top: 545, width: 1280, height: 255 },
  tools: { left: 970, top: 8, width: 300, height: 36 },
};

const overlap = (a: Box, b: Box) =>
  a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height;

test.each(Object.entries(PARTS))("the card beside the %s covers nothing of it and is whole", (_, part) => {
  const card = { ...placed(part, CARD, DESK), ...CARD };
  expect(overlap(card, part)).toBe(false);
  expect(shownPart(card, DESK)).toEqual(card);
});

test.each([
  [DESK, { left: 0, top: 0, ...DESK }],
  [
    { width: 820, height: 400 },
    { left: 0, top: 0, width: 820, height: 390 },
  ],
])("a part that fills the window has the card inside", (view, part) => {
  const card = { ...placed(part, CARD, view), ...CARD };
  expect(shownPart(card, view)).toEqual(card);
});

test("on a telephone the card is at the foot, whatever it points at", () => {
  const view = { width: 390, height: 844 };
  const card = { width: 362, height: 250 };
  for (const part of Object.values(PARTS)) {
    const { left, top } = placed(part, card, view);
    expect([left, top + card.height]).toEqual([14, 830]);
  }
});

test("the ring stays in the window", () => {
  expect(shownPart({ left: -5, top: 700, width: 400, height: 400 }, DESK)).toEqual({
    left: 0,
    top: 700,
    width: 395,
    height: 100,
  });
  expect(shownPart({ left: 0, top: 900, width: 10, height: 10 }, DESK).height).toBe(0);
});
