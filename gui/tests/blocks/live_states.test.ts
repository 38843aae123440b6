// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { CheckCondition, Condition, Live, RuleDocument } from "../../src/api/types";
import { ruleStates, timesOf } from "../../src/blocks/live_states";

const check = (value: number): CheckCondition => ({
  kind: "check",
  topic: "/odom",
  property: "pose_x",
  op: ">",
  value,
});
const held = (term: Condition, value: number): Condition => ({
  kind: "timed",
  term,
  word: "For",
  duration: { value, unit: "s" },
});
const CONDITION: Condition = {
  kind: "and",
  terms: [held({ kind: "not", term: held(check(1), 1) }, 2), held(check(2), 3)],
};

test("times are in the order in which they end in the text", () => {
  expect(timesOf(CONDITION).map(({ duration }) => duration.value)).toEqual([1, 2, 3]);
});

test("what a robot says of times is shown only where it has as many", () => {
  const statement = { kind: "rule", id: "s1", label: "Far", name: "Far", condition: CONDITION };
  const document = { collections: [{ statements: [statement] }] } as unknown as RuleDocument;
  const times = [1, 2, 3].map((held_s) => ({ state: "false", held_s }));
  const live = (some: typeof times) => {
    const rows = some.map(({ state, held_s }, at) => [4, at, state, held_s]);
    const status = { blocks: [{ state: "false", checks: [], times: rows }] };
    return { status, labels: ["Far"], checks: [] } as unknown as Live;
  };
  expect(ruleStates(document, live(times)).get("s1")?.times).toEqual(times);
  expect(ruleStates(document, live(times.slice(1))).get("s1")?.times).toEqual([]);
});
