// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { RuleBlock } from "./block_types";

/** Adds a check below the last one: the other bound of it, as most zones have two. */
export function addCheck(block: Blockly.BlockSvg): void {
  const input = block.getInput("IF") ? "IF" : "TERMS";
  const last = lastIn(block, input);
  const model = last?.type === "adirf_check" ? last : null;
  const bounded = model?.getPreviousBlock();
  const sameProperty =
    bounded?.type === "adirf_check" && bounded.getFieldValue("PROPERTY") === model?.getFieldValue("PROPERTY");
  append(block, input, "adirf_check", {
    TOPIC: model?.getFieldValue("TOPIC") ?? "/odom",
    PROPERTY: model?.getFieldValue("PROPERTY") ?? "pose_x",
    OP: model && !sameProperty && model.getFieldValue("OP") === ">" ? "<" : ">",
    VALUE: 0,
  });
}

/** Adds a rate for a topic that the part does not set yet. */
export function addRate(block: Blockly.BlockSvg, input: string, topics: readonly string[]): void {
  const taken = new Set<unknown>();
  for (let set = block.getInputTargetBlock(input); set; set = set.getNextBlock()) taken.add(set.getFieldValue("TOPIC"));
  const topic = topics.find((each) => !taken.has(each)) ?? "/topic";
  const rate = lastIn(block, input)?.getFieldValue("RATE") ?? "10";
  append(block, input, "adirf_set", { TOPIC: topic, RATE: rate });
}

export function toggleElse(block: Blockly.BlockSvg, topics: readonly string[]): void {
  Blockly.Events.setGroup(true);
  const rule = block as RuleBlock;
  const shown = rule.getInput("ELSE") !== null;
  if (shown) rule.getInputTargetBlock("ELSE")?.dispose(false);
  rule.setElse(!shown);
  if (!shown) addRate(rule, "ELSE", topics);
  else Blockly.Events.fire(new Blockly.Events.BlockChange(block, "mutation", null, null, ""));
  Blockly.Events.setGroup(false);
}

function lastIn(block: Blockly.Block, input: string): Blockly.Block | null {
  return block.getInputTargetBlock(input)?.lastConnectionInStack(true)?.getSourceBlock() ?? null;
}

function append(block: Blockly.BlockSvg, input: string, type: string, fields: Record<string, unknown>): void {
  const added = Blockly.serialization.blocks.append({ type, fields }, block.workspace) as Blockly.BlockSvg;
  const connection = lastIn(block, input)?.nextConnection ?? block.getInput(input)?.connection;
  if (connection && added.previousConnection) connection.connect(added.previousConnection);
  const first = added.getField(type === "adirf_set" ? "TOPIC" : "VALUE");
  if (first) Blockly.getFocusManager().focusNode(first);
}
