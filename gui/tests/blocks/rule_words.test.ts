// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { RuleStatement, SetStatement } from "../../src/api/types";
import { ruleName, ruleSets } from "../../src/blocks/rule_words";

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
