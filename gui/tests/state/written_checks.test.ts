// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import type { CheckCondition, RuleStatement } from "../../src/api/types";
import { checkOfRobot, checksIn, thresholdEdits, writeThreshold } from "../../src/state/written_checks";
import { openRules } from "./served";

const check = (value: number, offset: number): CheckCondition => ({
  kind: "check",
  topic: "/odom",
  property: "pose_y",
  op: ">",
  value,
  offset,
});
const RULE: RuleStatement = {
  kind: "rule",
  id: "7",
  key: "a1-1",
  name: "Far",
  offset: 10,
  end_offset: 90,
  condition: {
    kind: "or",
    terms: [
      { kind: "not", term: check(5, 20) },
      {
        kind: "timed",
        word: "For",
        duration: { value: 2, unit: "s" },
        term: { ...check(8, 40), until: { op: "<", value: 7 } },
      },
      {
        kind: "timed",
        word: "Within",
        duration: { value: 1, unit: "min" },
        term: { kind: "and", terms: [check(9, 60)] },
      },
    ],
  },
  // biome-ignore lint/suspicious/noThenProperty: a rule's word
  then: [],
  else: [],
};

afterEach(() => vi.unstubAllGlobals());

test("each check is told as it is written, with the time on it alone", () => {
  expect(checksIn([RULE]).map(({ rule, words, condition }) => [rule, words, condition.kind])).toEqual([
    ["Far", "/odom pose_y > 5", "check"],
    ["Far", "/odom pose_y > 8 Until < 7 For 2 s", "timed"],
    ["Far", "/odom pose_y > 9", "check"],
  ]);
});

test("another threshold is written where the check is, and nowhere else", () => {
  const [, second] = checksIn([RULE]);
  if (!second) throw new Error("the rule has checks");
  const [edit] = thresholdEdits([RULE], second, 8.5);
  const written = edit?.kind === "replace" ? checksIn([edit.statement]).map(({ words }) => words) : [];
  expect(written).toEqual(["/odom pose_y > 5", "/odom pose_y > 8.5 Until < 7 For 2 s", "/odom pose_y > 9"]);
  expect(thresholdEdits([{ ...RULE, key: "b2-1" }], second, 1)).toEqual([]);
});

test("a threshold goes into its check although the rule stands elsewhere by now", () => {
  const rule = (line: number): RuleStatement => ({
    ...RULE,
    condition: { kind: "or", terms: [check(5, line + 20), check(8, line + 40)] },
  });
  const [, second] = checksIn([rule(0)]);
  if (!second) throw new Error("the rule has checks");
  for (const line of [1, 20]) {
    const [edit] = thresholdEdits([rule(line)], second, 8.5);
    const written = edit?.kind === "replace" ? checksIn([edit.statement]).map(({ words }) => words) : [];
    expect(written).toEqual(["/odom pose_y > 5", "/odom pose_y > 8.5"]);
  }
});

test("that a threshold is not written, as its rule is another one by now, is said", async () => {
  const [one] = checksIn([RULE]);
  const editor = await openRules({ text: "begin\nend\n" });
  await writeThreshold(editor, 7, () => one, "The rule was changed meanwhile");
  expect(editor.message.value).toBe("The rule was changed meanwhile, so 7 was not written");
});

test("a robot's check is that of the rule of its name, or else the only one with its words", () => {
  const rule = (name: string): RuleStatement => ({ ...RULE, name, key: name, condition: check(5, 20) });
  const told = { rule: "Near", topic: "/odom", property: "pose_y", op: ">", limit: 5 } as const;
  const found = (...names: string[]) => checkOfRobot(names.map(rule), told)?.rule;
  expect([found("Far", "Near"), found("Far"), found("Far", "Farther"), found()]).toEqual([
    "Near",
    "Far",
    undefined,
    undefined,
  ]);
});
