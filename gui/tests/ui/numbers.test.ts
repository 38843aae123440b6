// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { expect, test } from "vitest";
import table from "../../../tests/golden/numbers.json";
import {
  durationWords,
  fixed,
  hz,
  kilobytes,
  numberProblem,
  percent,
  readable,
  typedNumber,
} from "../../src/ui/numbers";

test.each([
  ["3.5", 3.5],
  ["3,5", 3.5],
  [" 12 ", 12],
  ["-1,25", -1.25],
  ["−2", -2],
  ["1e3", 1000],
  ["0", 0],
  ["0,5", 0.5],
  ["0,125", 0.125],
  ["12,5", 12.5],
  ["1.125", 1.125],
  ["12 000", 12000],
])("%j is a number, with a point or a comma before its decimals", (text, value) => {
  expect(typedNumber(text)).toBe(value);
});

test.each(["", "  ", "ten", "1.000,5", "1,000,5", "5 Hz", "3.5.1", "1,000", "12,500"])("%j is no number", (text) => {
  expect(typedNumber(text)).toBeNaN();
});

test.each([
  ["1,000", "“1,000” can mean 1 or 1000: write 1 or 1000"],
  ["12,500", "“12,500” can mean 12.5 or 12500: write 12.5 or 12500"],
  ["1.234,5", "“1.234,5” has thousands marked: write 1234.5"],
  ["1,234.5", "“1,234.5” has thousands marked: write 1234.5"],
  ["ten", "“ten” is not a number"],
  ["1e999", "“1e999” is too large a number"],
  ["", "A number is needed here"],
  ["0,5", ""],
])("of %j is said %j", (text, words) => {
  expect(numberProblem(text, false)).toBe(words);
});

test("a point before three digits can mark thousands for who writes decimals with a comma", () => {
  expect(typedNumber("1.000", false)).toBe(1);
  expect(typedNumber("1.000", true)).toBeNaN();
  expect(numberProblem("6.220", true)).toBe("“6.220” can mean 6.22 or 6220: write 6.22 or 6220");
  // The page itself writes numbers so.
  expect(typedNumber("1.125", true)).toBe(1.125);
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

// The terminal is tested with the same table.
test.each(table.kilobytes as [number, string][])("%d KB are read as %s, as in the terminal", (value, text) => {
  expect(kilobytes(value)).toBe(text);
});

test.each(table.fixed as [number, number, string][])(
  "%d with %d decimals is read as %s, as in the terminal",
  (value, decimals, text) => {
    expect(fixed(value, decimals)).toBe(text);
  },
);

test.each(table.percent as [number, number, string][])(
  "%d percent with %d decimals is read as %s, as in the terminal",
  (value, decimals, text) => {
    expect(percent(value, decimals)).toBe(text);
  },
);

test.each(table.kilobytes as [number, string][])(
  "%d is what somebody means who types it as it is shown: %s",
  (value, text) => {
    expect(kilobytes(typedNumber(text))).toBe(text);
    expect(Math.abs(typedNumber(text) - value)).toBeLessThan(0.01);
  },
);

test.each([
  [0, "0 s"],
  [119.4, "119 s"],
  [120, "2 min"],
  [4534, "75.6 min"],
])("%d s are read as %s", (seconds, words) => {
  expect(durationWords(seconds)).toBe(words);
});

test("a rate says its unit, and every message is Full", () => {
  expect([hz(2.5), hz(0), hz(null)]).toEqual(["2.5 Hz", "0 Hz", "Full"]);
});
