// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import { ALL_TOPICS, parseBound, parseTopics, topicsText } from "../../src/blocks/field_text";

test.each([
  ["0.05", 0.05],
  [" 0,05 ", 0.05],
  ["0", 0],
  ["acceptable", "Acceptable"],
])("%j is understood as a bound", (text, bound) => {
  expect(parseBound(text)).toBe(bound);
});

test.each(["", "-1", "5 cm", "Full", "Infinity"])("%j is no bound", (text) => {
  expect(parseBound(text)).toBeNull();
});

test("topics to record are words, and none stand for all", () => {
  expect(parseTopics(" /scan, /odom\timu ")).toEqual(["/scan", "/odom", "imu"]);
  expect(topicsText(["/scan", "/odom"])).toBe("/scan /odom");
  expect(parseTopics("")).toEqual([]);
  expect(topicsText([])).toBe(ALL_TOPICS);
  expect(parseTopics(ALL_TOPICS)).toEqual([]);
});
