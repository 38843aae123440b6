// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { CheckCondition, RuleStatement } from "../../src/api/types";
import { checksIn, thresholdEdits } from "../../src/state/written_checks";

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
