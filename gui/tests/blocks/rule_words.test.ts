// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { RuleStatement, SetStatement } from "../../src/api/types";
import {
  ALL_TOPICS,
  parseBound,
  parseRate,
  parseTopics,
  RATE_WORDS,
  rateText,
  ruleName,
  ruleSets,
  topicsText,
} from "../../src/blocks/rule_words";

const set = (topic: string, value: number): SetStatement => ({ kind: "set", topic, rate: { kind: "hz", value } });
const rule = (then: SetStatement[], otherwise: SetStatement[] = []) =>
  ({ kind: "rule", then, else: otherwise }) as unknown as RuleStatement;

test("what a rule sets is said in the room that there is", () => {
  expect(ruleSets(rule([set("/a", 1)], [set("/a", 2)]), 40)).toBe("/a 1 Hz, else /a 2 Hz");
  expect(ruleSets(rule([set("/a", 1), set("/b", 2), set("/c", 3)]), 18)).toBe("/a 1 Hz, /b 2 Hz and 1 more");
  expect(ruleSets(rule([set("/a/very/long/topic", 1), set("/b", 2)]), 8)).toBe("/a/very… and 1 more");
});

test("a rule without a name is called by its condition", () => {
  const check = { kind: "check", topic: "/odom", property: "pose_x", op: ">", value: 3 };
  expect(ruleName({ condition: check } as unknown as RuleStatement)).toBe("if /odom pose_x > 3");
  const all = { kind: "all", terms: [check, check] };
  expect(ruleName({ condition: all } as unknown as RuleStatement)).toBe("if /odom pose_x > 3 …");
});

test.each([
  ["10", { kind: "hz", value: 10 }],
  ["2,5 Hz", { kind: "hz", value: 2.5 }],
  ["0.1hz", { kind: "hz", value: 0.1 }],
  [" full ", { kind: "full", value: null }],
  ["OFF", { kind: "off", value: null }],
  ["desirable", { kind: "tier", value: "Desirable" }],
])("%j is understood as a rate", (text, rate) => {
  expect(parseRate(text)).toEqual(rate);
});

test.each(["", "Hz", "-1", "fast", "Infinity", "1e999", "10 kHz"])("%j is no rate", (text) => {
  expect(parseRate(text)).toBeNull();
});

test("what a block shows of a rate means the same when it is typed", () => {
  for (const text of [...RATE_WORDS, "0", "0.25", "1000000"]) {
    const rate = parseRate(text);
    expect(rate && rateText(rate)).toBe(text);
  }
});

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
