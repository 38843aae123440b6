// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { hz, kilobytes, readable, typedNumber } from "../../src/ui/numbers";

test.each([
  ["3.5", 3.5],
  ["3,5", 3.5],
  [" 12 ", 12],
  ["-1,25", -1.25],
  ["−2", -2],
  ["1e3", 1000],
  ["0", 0],
])("%j is a number, with a point or a comma before its decimals", (text, value) => {
  expect(typedNumber(text)).toBe(value);
});

test.each(["", "  ", "ten", "1.000,5", "1,000,5", "5 Hz", "3.5.1"])("%j is no number", (text) => {
  expect(typedNumber(text)).toBeNaN();
});

test.each([
  [0.123456, "0.123"],
  [9.996, "10"],
  [-2.5, "-2.5"],
  [999, "999"],
  [1234.5, "1 235"],
  [1234567, "1 234 567"],
])("%d is read as %s", (value, text) => {
  expect(readable(value)).toBe(text);
});

test.each([
  [157665.721, "157 665.72"],
  [6358, "6 358"],
  [2.5, "2.5"],
  [0, "0"],
])("%d KB are read as %s, as in the terminal", (value, text) => {
  expect(kilobytes(value)).toBe(text);
});

test("a rate says its unit, and every message is Full", () => {
  expect([hz(2.5), hz(0), hz(null)]).toEqual(["2.5 Hz", "0 Hz", "Full"]);
});
