// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { holdsWords, stretches, type Turns } from "../../src/state/timeline";

const TURNS: Turns = [
  [0, "unknown"],
  [0, "false"],
  [2, "true"],
  [5, "false"],
  [6, "true"],
  [9, "unknown"],
];

test("a stretch ends where the next begins, at the end of the recording at last", () => {
  expect(stretches(TURNS, 7).map(({ truth, fromS, toS }) => [truth, fromS, toS])).toEqual([
    ["false", 0, 2],
    ["true", 2, 5],
    ["false", 5, 6],
    ["true", 6, 7],
  ]);
});

test.each([
  [TURNS, 10, "Holds for 6 s of 10 s, in 2 stretches; unknown for 1 s"],
  [TURNS.slice(0, 3), 8, "Holds for 6 s of 8 s"],
  [TURNS.slice(0, 2), 8, "Never holds"],
] as const)("%o in %d s is told as %s", (turns, durationS, words) => {
  expect(holdsWords(turns, durationS)).toBe(words);
});
