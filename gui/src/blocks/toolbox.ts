// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Condition, RuleStatement, SetStatement, Statement } from "../api/types";
import { toBlock } from "./model";

const set = (topic: string, hz: number): SetStatement => ({ kind: "set", topic, rate: { kind: "hz", value: hz } });
const check = (topic: string, property: string, op: "<" | ">", value: number): Condition => ({
  kind: "check",
  topic,
  property,
  op,
  value,
});
const rule = (condition: Condition, then: SetStatement[]) =>
  ({ kind: "rule", name: null, priority: 0, condition, then, else: [] }) satisfies RuleStatement;

/** The rule that a new project's first rule block is. */
export const NEW_RULE = rule(check("/odom", "pose_x", ">", 0), [set("/odom", 10)]);
export const NEW_RATE = set("/odom", 10);
const TIMES: Record<string, unknown>[] = [
  { extraState: { times: 1 }, fields: { WORD0: "For" } },
  { extraState: { times: 1 }, fields: { WORD0: "Within" } },
  { extraState: { hasUntil: true }, fields: { UNTIL_OP: "<" } },
];

/** The blocks to take from: what a statement may be, what a condition may be, and the rules of recipes. */
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
      { kind: "category", name: "Bounds", categorystyle: "floor", contents: [block({ type: "adirf_within" })] },
      { kind: "category", name: "Recordings", categorystyle: "record", contents: [block({ type: "adirf_record" })] },
      { kind: "category", name: "Rules", categorystyle: "rule", contents: [block(toBlock(NEW_RULE))] },
      {
        kind: "category",
        name: "Checks",
        categorystyle: "check",
        contents: ["adirf_check", "adirf_any", "adirf_all", "adirf_not"].map((type) => block({ type })),
      },
      {
        kind: "category",
        name: "Times",
        categorystyle: "check",
        contents: [
          ...TIMES.map((state) => block({ type: "adirf_check", ...state })),
          block({ type: "adirf_all", extraState: { times: 1 } }),
        ],
      },
      { kind: "category", name: "Recipes", categorystyle: "rule", custom: RECIPES },
    ],
  };
}

type Shown = Blockly.utils.toolbox.FlyoutItemInfo[];

const LOADING = { kind: "label", text: "Loading …" } as Shown[number];

/** The category of the toolbox whose rules are asked for when it is opened first. */
const RECIPES = "RECIPES";

/** Fills the category of recipes, at first with a word until the rules are there. */
export function offerRecipes(
  workspace: Blockly.WorkspaceSvg,
  recipes: () => Promise<readonly Statement[] | null>,
): void {
  let shown: Shown | null = null;
  let isAsked = false;
  const ask = async () => {
    isAsked = true;
    const rules = await recipes();
    isAsked = false;
    if (rules === null) return;
    shown = rules.map((each) => ({ kind: "block", ...toBlock(each) }));
    // The page may have been left meanwhile.
    if (workspace.rendered) workspace.refreshToolboxSelection();
  };
  workspace.registerToolboxCategoryCallback(RECIPES, () => {
    if (shown === null && !isAsked) void ask();
    return shown ?? [LOADING];
  });
}
