// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import { parseBound } from "./field_text";
import type { Suggestions } from "./fields";

const CONDITIONS = new Set(["adirf_check", "adirf_all", "adirf_any", "adirf_not"]);

/** Writes AND or OR before every check that stands below another, and units behind values and bounds. */
export function showJoins(workspace: Blockly.WorkspaceSvg, suggest: Suggestions): void {
  for (const block of workspace.getAllBlocks(false)) {
    if (block.isInsertionMarker()) continue;
    if (CONDITIONS.has(block.type)) write(block, "JOIN", joinOf(block));
    if (block.type !== "adirf_check" && block.type !== "adirf_within") continue;
    const unit = suggest.unit(String(block.getFieldValue("TOPIC")), String(block.getFieldValue("PROPERTY")));
    const isLevel = typeof parseBound(String(block.getFieldValue("BOUND"))) === "string";
    write(block, "UNIT", isLevel ? "" : unit);
    write(block, "UNTIL_UNIT", unit);
  }
}

function write(block: Blockly.Block, name: string, text: string): void {
  if (block.getField(name) && block.getFieldValue(name) !== text) block.setFieldValue(text, name);
}

function joinOf(block: Blockly.Block): string {
  const above = block.getPreviousBlock();
  if (!above || above === block.getSurroundParent()) return "";
  return block.getSurroundParent()?.type === "adirf_any" ? "OR" : "AND";
}
