// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import type { PickerChoice } from "../ui/picker_matches";
import type { RuleBlock } from "./block_types";
import { stacked } from "./conditions";
import type { Suggestions } from "./fields";
import { openField } from "./open_field";

/**
 * Adds a check below the last one: the other bound of it, as most zones have two; where it has both already, one of
 * the topic's next property.
 */
export function addCheck(block: Blockly.BlockSvg, suggest: Suggestions): void {
  const input = block.getInput("IF") ? "IF" : "TERMS";
  const last = lastIn(block, input);
  const model = last?.type === "adirf_check" ? last : null;
  const topic = String(model?.getFieldValue("TOPIC") ?? "/odom");
  const property = String(model?.getFieldValue("PROPERTY") ?? "pose_x");
  const bounded = model?.getPreviousBlock();
  const hasBoth = bounded?.type === "adirf_check" && bounded.getFieldValue("PROPERTY") === property;
  const isBelow = model !== null && !hasBoth && model.getFieldValue("OP") === ">";
  const fields = {
    TOPIC: topic,
    PROPERTY: hasBoth ? after(property, suggest.properties(topic)) : property,
    OP: isBelow ? "<" : ">",
    VALUE: 0,
  };
  append(block, input, "adirf_check", fields, "VALUE");
}

/** The word behind another one; that itself where there is none. */
function after(word: string, all: readonly PickerChoice[]): string {
  const at = all.findIndex((each) => each.word === word);
  return (at < 0 ? undefined : all[at + 1]?.word) ?? word;
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
  const all = suggest.topics().flatMap((topic) => suggest.bounds(topic).map(({ word }) => ({ topic, property: word })));
  const free = all.filter(({ topic, property }) => !isTaken(topic, property));
  const { topic, property } = free.find((each) => each.property === "position") ??
    free[0] ?? { topic: "/odom", property: "position" };
  append(block, input, "adirf_within", { TOPIC: topic, PROPERTY: property }, "TOPIC");
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

/** Puts a new block below the last one of a part, and opens its field `first`. */
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
  openField(added.getField(first));
}
