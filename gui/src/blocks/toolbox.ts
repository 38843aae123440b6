// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Condition, RuleStatement, SetStatement } from "../api/types";
import { toBlock } from "./model";

const set = (topic: string, hz: number): SetStatement => ({ kind: "set", topic, rate: { kind: "hz", value: hz } });
const check = (topic: string, property: string, op: "<" | ">", value: number): Condition => ({
  kind: "check",
  topic,
  property,
  op,
  value,
});
const rule = (name: string | null, condition: Condition, then: SetStatement[], otherwise: SetStatement[] = []) =>
  ({ kind: "rule", name, priority: 0, condition, then, else: otherwise }) satisfies RuleStatement;

/** The rule that a new project's first rule block is. */
export const NEW_RULE = rule(null, check("/odom", "pose_x", ">", 0), [set("/odom", 10)]);
export const NEW_RATE = set("/odom", 10);

const RECIPES: readonly RuleStatement[] = [
  rule("Low battery", check("/battery_state", "level", "<", 20), [set("/camera/image_raw", 2), set("/scan", 3)]),
  rule(
    "Emergency",
    { kind: "or", terms: [check("/scan", "distance", "<", 0.5), check("/odom", "speed", ">", 2.5)] },
    [set("/cmd_vel", 100), set("/scan", 50)],
  ),
  rule(
    "Corridor",
    {
      kind: "and",
      terms: [
        check("/odom", "pose_x", ">", 0),
        check("/odom", "pose_x", "<", 10),
        check("/odom", "pose_y", ">", 0),
        check("/odom", "pose_y", "<", 2),
      ],
    },
    [set("/odom", 4), set("/scan", 4)],
  ),
  rule("Failing sensor", check("/scan", "age", ">", 1), [set("/camera/image_raw", 10)]),
];

/** The blocks to take from: what a statement may be, what a condition may be, and whole recipes. */
export function toolbox(): Blockly.utils.toolbox.ToolboxDefinition {
  const block = (state: Blockly.serialization.blocks.State) => ({ kind: "block", ...state });
  return {
    kind: "categoryToolbox",
    contents: [
      {
        kind: "category",
        name: "Rates",
        categorystyle: "rate",
        contents: [block(toBlock(NEW_RATE)), block({ type: "adirf_keep" })],
      },
      { kind: "category", name: "Rules", categorystyle: "rule", contents: [block(toBlock(NEW_RULE))] },
      {
        kind: "category",
        name: "Checks",
        categorystyle: "check",
        contents: ["adirf_check", "adirf_any", "adirf_all", "adirf_not"].map((type) => block({ type })),
      },
      { kind: "category", name: "Recipes", categorystyle: "rule", contents: RECIPES.map((each) => block(toBlock(each))) },
    ],
  };
}
