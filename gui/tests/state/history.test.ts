// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { History } from "../../src/state/history";

test("undo goes back change by change, and redo forward again", () => {
  const history = new History();
  history.push("one");
  history.push("two");
  expect(history.undo("three")).toBe("two");
  expect(history.undo("two")).toBe("one");
  expect(history.undo("one")).toBeNull();
  expect(history.redo("one")).toBe("two");
  expect(history.redo("two")).toBe("three");
  expect(history.redo("three")).toBeNull();
});

test("a change after undo leaves nothing to redo", () => {
  const history = new History();
  history.push("one");
  history.undo("two");
  expect(history.canRedo.value).toBe(true);
  history.push("one");
  expect(history.canRedo.value).toBe(false);
});

test("letters typed in one go are one step, and a pause begins another", () => {
  const history = new History();
  history.push("", 0);
  history.push("a", 300);
  history.push("ab", 600);
  history.push("abc", 5000);
  expect(history.undo("abcd")).toBe("abc");
  expect(history.undo("abc")).toBe("");
  expect(history.canUndo.value).toBe(false);
});

test("typing goes not on across an undo or a change by mouse", () => {
  const history = new History();
  history.push("", 0);
  history.push("a", 100);
  history.undo("ab");
  history.push("", 200);
  history.push("x");
  history.push("xy", 300);
  expect(history.undo("xyz")).toBe("xy");
  expect(history.undo("xy")).toBe("x");
  expect(history.undo("x")).toBe("");
});

test("500 steps are kept, the newest", () => {
  const history = new History();
  for (let change = 0; change < 600; change++) history.push(`text ${change}`);
  const undone: string[] = [];
  for (let text = history.undo("now"); text !== null; text = history.undo(text)) undone.push(text);
  expect(undone).toHaveLength(500);
  expect([undone[0], undone.at(-1)]).toEqual(["text 599", "text 100"]);
});

test("of very large texts fewer steps are kept, but always one", () => {
  const history = new History();
  const large = "x".repeat(60_000_000);
  history.push("small");
  history.push(large);
  expect(history.undo("now")).toBe(large);
  expect(history.undo(large)).toBeNull();
});
