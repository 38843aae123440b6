// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import {
  comparedProblem,
  isOfEquality,
  parseCompared,
  parseParameter,
  quoted,
  unquoted,
} from "../../src/blocks/compared";

test.each([
  ["3.5", 3.5],
  [" -2 ", -2],
  ["1e3", 1000],
  ["TRUE", "true"],
  ["ERROR", "ERROR"],
  ["diagnostic_msgs/msg/DiagnosticStatus.ERROR", "diagnostic_msgs/msg/DiagnosticStatus.ERROR"],
  ["docking", '"docking"'],
  ["on the way", '"on the way"'],
  ['say "hi"', '"say \\"hi\\""'],
  ['"5"', '"5"'],
])("somebody who types %j compares with %j", (typed, value) => {
  expect(parseCompared(typed)).toBe(value);
  expect(comparedProblem(typed)).toBe("");
});

test.each(["", " ", "5m", "1.000,5", '"open', '"a"b"'])("%j is nothing to compare with, and that is said", (typed) => {
  expect(parseCompared(typed)).toBeNull();
  expect(comparedProblem(typed)).not.toBe("");
});

test("a text keeps its quotes and backslashes", () => {
  for (const text of ['say "hi"', "C:\\new", "\\", '"', ""]) expect(unquoted(quoted(text))).toBe(text);
});

test("texts, true and false can be equal or not, constants also less", () => {
  expect(['"docking"', "true", "ERROR", 5].map(isOfEquality)).toEqual([true, true, false, false]);
});

test.each([
  ["1.0", "1.0"],
  ["40", "40"],
  ["True", "true"],
  ["slow", '"slow"'],
  ["SLOW", '"SLOW"'],
  ["1,5", "1.5"],
  ["5m", null],
])("the parameter that somebody types as %j is written %j", (typed, written) => {
  expect(parseParameter(typed)).toBe(written);
});
