// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { RuleBlock } from "./block_types";
import { stacked } from "./conditions";
import type { Suggestions } from "./fields";

/** Adds a check below the last one: the other bound of it, as most zones have two. */
export function addCheck(block: Blockly.BlockSvg): void {
  const input = block.getInput("IF") ? "IF" : "TERMS";
  const last = lastIn(block, input);
  const model = last?.type === "adirf_check" ? last : null;
  const bounded = model?.getPreviousBlock();
  const sameProperty =
    bounded?.type === "adirf_check" && bounded.getFieldValue("PROPERTY") === model?.getFieldValue("PROPERTY");
  append(
    block,
    input,
    "adirf_check",
    {
      TOPIC: model?.getFieldValue("TOPIC") ?? "/odom",
      PROPERTY: model?.getFieldValue("PROPERTY") ?? "pose_x",
      OP: model && !sameProperty && model.getFieldValue("OP") === ">" ? "<" : ">",
      VALUE: 0,
    },
    "VALUE",
  );
}

/** Adds a rate for a topic that the part does not set yet. */
export function addRate(block: Blockly.BlockSvg, input: string, topics: readonly string[]): void {
  const sets = stacked(block, input).filter(({ type }) => type === "adirf_set");
  const topic = topics.find((each) => sets.every((set) => set.getFieldValue("TOPIC") !== each)) ?? "/topic";
  const rate = sets.at(-1)?.getFieldValue("RATE") ?? "10";
  append(block, input, "adirf_set", { TOPIC: topic, RATE: rate }, "TOPIC");
}

/** Adds a bound for a property that the part does not bound yet, of a topic that has some for it first. */
export function addBound(block: Blockly.BlockSvg, input: string, suggest: Suggestions): void {
  const bounds = stacked(block, input).filter(({ type }) => type === "adirf_within");
  const isTaken = (topic: string, property: string) =>
    bounds.some((each) => each.getFieldValue("TOPIC") === topic && each.getFieldValue("PROPERTY") === property);
  const all = suggest.topics().flatMap((topic) => suggest.bounds(topic).map((property) => ({ topic, property })));
  const free = all.filter(({ topic, property }) => !isTaken(topic, property));
  const { topic, property } = free.find((each) => each.property === "position") ??
    free[0] ?? { topic: "/odom", property: "position" };
  append(block, input, "adirf_within", { TOPIC: topic, PROPERTY: property }, "BOUND");
}

export function addRecord(block: Blockly.BlockSvg, input: string): void {
  append(block, input, "adirf_record", {}, "NAME");
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

/** Puts a new block below the last one of a part, and the focus on its field `first`. */
function append(
  block: Blockly.BlockSvg,
  input: string,
  type: string,
  fields: Record<string, unknown>,
  first: string,
): void {
  const added = Blockly.serialization.blocks.append({ type, fields }, block.workspace) as Blockly.BlockSvg;
  const connection = lastIn(block, input)?.nextConnection ?? block.getInput(input)?.connection;
  if (connection && added.previousConnection) connection.connect(added.previousConnection);
  const field = added.getField(first);
  if (field) Blockly.getFocusManager().focusNode(field);
}
