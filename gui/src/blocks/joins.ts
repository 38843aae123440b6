// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Suggestions } from "./block_types";

const CONDITIONS = new Set(["adirf_check", "adirf_all", "adirf_any", "adirf_not"]);

/** Writes AND or OR before every check that stands below another, and the unit behind its value. */
export function showJoins(workspace: Blockly.WorkspaceSvg, suggest: Suggestions): void {
  for (const block of workspace.getAllBlocks(false)) {
    if (!CONDITIONS.has(block.type) || block.isInsertionMarker()) continue;
    const join = joinOf(block);
    if (block.getFieldValue("JOIN") !== join) block.setFieldValue(join, "JOIN");
    if (block.type !== "adirf_check") continue;
    const unit = suggest.unit(String(block.getFieldValue("TOPIC")), String(block.getFieldValue("PROPERTY")));
    if (block.getFieldValue("UNIT") !== unit) block.setFieldValue(unit, "UNIT");
  }
}

function joinOf(block: Blockly.Block): string {
  const above = block.getPreviousBlock();
  if (!above || above === block.getSurroundParent()) return "";
  return block.getSurroundParent()?.type === "adirf_any" ? "OR" : "AND";
}
