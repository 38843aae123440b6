// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Statement } from "../api/types";
import { toBlock } from "./model";

type Shown = Blockly.utils.toolbox.FlyoutItemInfo[];

const LOADING = { kind: "label", text: "Loading …" } as Shown[number];

/** The category of the toolbox whose rules are asked for when it is opened first. */
export const RECIPES = "RECIPES";

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
