// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { TimeWord, Truth } from "../../src/api/types";
import { checkWords, timeWords } from "../../src/blocks/badges";
import type { TimeState } from "../../src/blocks/live_states";

const TEN = { value: 10, unit: "s" } as const;

test.each<[TimeWord, Truth, number | null, string]>([
  ["For", "unknown", null, "? not known for 10 s yet"],
  ["For", "false", 0, "✗ does not hold now"],
  ["For", "false", 6.94, "✗ holds for 6 s of 10 s"],
  ["For", "unknown", 0.25, "? holds for 250 ms of 10 s"],
  ["For", "true", 10, "✓ holds for 10 s"],
  ["For", "true", 3600, "✓ holds for 60 min"],
  ["Within", "true", 0, "✓ holds now"],
  ["Within", "true", 4, "✓ held 4 s ago"],
  ["Within", "false", 11, "✗ not in the last 10 s"],
  ["Within", "unknown", 5, "? not for 5 s"],
])("a badge says of a %s that is %s since %j s: %s", (word, state, held_s, words) => {
  const time: TimeState = { state, held_s };
  expect(timeWords(time, { word, duration: TEN })).toBe(words);
});

test("a badge says what a check reads", () => {
  expect(checkWords({ state: "true", value: 18.26 }, "%")).toBe("✓ true 18.3 %");
  expect(checkWords({ state: "unknown", value: null }, "%")).toBe("? unknown");
});
