// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { dropIndex, stacksOf, topsOf, withLoose } from "../../src/blocks/column";

test("stacks of any heights stand one below the other with the same gaps", () => {
  expect(topsOf([], 18, 18)).toEqual([]);
  expect(topsOf([48, 284, 0, 96], 18, 18)).toEqual([18, 84, 386, 404]);
});

test("a pinned stack stays, and the others stand around it", () => {
  expect(topsOf([48, 284, 96], 18, 18, { index: 1, top: 500 })).toEqual([434, 500, 802]);
  expect(topsOf([48, 284], 18, 18, { index: 0, top: -7 })).toEqual([-7, 59]);
});

test("what is not in the text stays behind what it stood behind, and behind the next above where that went", () => {
  expect(withLoose(["b", "a"], ["a", "loose", "b"])).toEqual(["b", "a", "loose"]);
  expect(withLoose(["a", "new"], ["loose", "a", "gone", "other"])).toEqual(["loose", "a", "gone", "other", "new"]);
  expect(withLoose([], ["x", "y"])).toEqual(["x", "y"]);
});

test("what is dropped comes before what it covers less than half of", () => {
  const things = [
    { top: 18, height: 48 },
    { top: 84, height: 284 },
  ];
  expect([-50, 41, 43, 200, 227, 9000].map((y) => dropIndex(things, y))).toEqual([0, 0, 1, 1, 2, 2]);
});

test("neighbours that hang together are one stack", () => {
  expect(stacksOf([1, 3, 2, 4, 6, 5], (number) => number % 2 === 0)).toEqual([[1], [3], [2, 4, 6], [5]]);
  expect(stacksOf([], () => true)).toEqual([]);
});
