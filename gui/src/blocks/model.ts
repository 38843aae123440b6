// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Condition, Operator, SetStatement, Statement } from "../api/types";
import { parseRate, rateText } from "./rate_text";

type State = Blockly.serialization.blocks.State;

/** A statement as a block to load. */
export function toBlock(statement: Statement): State {
  const icons = statement.comments?.length ? { icons: { comment: { text: statement.comments.join("\n") } } } : {};
  return { ...statementBlock(statement), ...icons };
}

function statementBlock(statement: Statement): State {
  switch (statement.kind) {
    case "set":
      return { type: "adirf_set", fields: { TOPIC: statement.topic, RATE: rateText(statement.rate) } };
    case "keep":
      return { type: "adirf_keep", fields: { TOPIC: statement.topic, HZ: statement.hz } };
    case "raw":
      return { type: "adirf_raw" };
    case "rule": {
      const inputs: NonNullable<State["inputs"]> = {
        IF: { block: stack(terms(statement.condition).map(conditionBlock)) },
        THEN: { block: stack(statement.then.map(statementBlock)) },
      };
      if (statement.else.length > 0) inputs.ELSE = { block: stack(statement.else.map(statementBlock)) };
      return {
        type: "adirf_rule",
        fields: { NAME: statement.name ?? "", PRIORITY: statement.priority },
        inputs,
        ...(statement.else.length > 0 ? { extraState: { hasElse: true } } : {}),
      };
    }
  }
}

/** A stack of checks means that all of them hold, so an AND is the stack of its terms. */
function terms(condition: Condition): Condition[] {
  return condition.kind === "and" ? condition.terms : [condition];
}

function conditionBlock(condition: Condition): State {
  switch (condition.kind) {
    case "check":
      return {
        type: "adirf_check",
        fields: {
          TOPIC: condition.topic,
          PROPERTY: condition.property,
          OP: condition.op,
          VALUE: condition.value,
        },
      };
    case "and":
      return { type: "adirf_all", inputs: { TERMS: { block: stack(condition.terms.map(conditionBlock)) } } };
    case "or":
      return { type: "adirf_any", inputs: { TERMS: { block: stack(condition.terms.map(conditionBlock)) } } };
    case "not":
      return { type: "adirf_not", inputs: { TERMS: { block: stack(terms(condition.term).map(conditionBlock)) } } };
  }
}

function stack(blocks: State[]): State {
  return blocks.reduceRight((below, block) => ({ ...block, next: { block: below } }));
}

/** The statement that a block says, or why it says none yet. */
export function toStatement(block: Blockly.Block): Statement | { missing: string } {
  const comments = block.getCommentText()?.split("\n") ?? null;
  const text = (name: string) => String(block.getFieldValue(name));
  switch (block.type) {
    case "adirf_set":
      return { ...setStatement(block), comments };
    case "adirf_keep":
      return { kind: "keep", topic: text("TOPIC"), hz: Number(text("HZ")), comments };
    case "adirf_rule": {
      const condition = joined(conditions(block, "IF"), "and");
      if (condition === null) return { missing: "IF needs a check" };
      const then = sets(block, "THEN");
      if (then.length === 0) return { missing: "THEN needs a rate" };
      if (block.getInput("ELSE") && sets(block, "ELSE").length === 0) return { missing: "ELSE needs a rate" };
      const name = text("NAME").trim() || null;
      const priority = name === null ? 0 : Number(text("PRIORITY"));
      return { kind: "rule", name, priority, condition, then, else: sets(block, "ELSE"), comments };
    }
    default:
      return { missing: "This belongs in a rule" };
  }
}

function setStatement(block: Blockly.Block): SetStatement {
  const rate = parseRate(String(block.getFieldValue("RATE"))) ?? { kind: "full", value: null };
  return { kind: "set", topic: String(block.getFieldValue("TOPIC")), rate };
}

function stacked(block: Blockly.Block, input: string): Blockly.Block[] {
  const blocks: Blockly.Block[] = [];
  let next = block.getInputTargetBlock(input);
  while (next) {
    if (!next.isInsertionMarker()) blocks.push(next);
    next = next.getNextBlock();
  }
  return blocks;
}

function sets(block: Blockly.Block, input: string): SetStatement[] {
  return stacked(block, input).map(setStatement);
}

function conditions(block: Blockly.Block, input: string): Condition[] {
  return stacked(block, input)
    .map(condition)
    .filter((each) => each !== null);
}

function joined(all: Condition[], kind: "and" | "or"): Condition | null {
  return all.length > 1 ? { kind, terms: all } : (all[0] ?? null);
}

/** Null for an `any of` with nothing inside. */
function condition(block: Blockly.Block): Condition | null {
  switch (block.type) {
    case "adirf_check":
      return {
        kind: "check",
        topic: String(block.getFieldValue("TOPIC")),
        property: String(block.getFieldValue("PROPERTY")),
        op: block.getFieldValue("OP") as Operator,
        value: Number(block.getFieldValue("VALUE")),
      };
    case "adirf_any":
      return joined(conditions(block, "TERMS"), "or");
    case "adirf_not": {
      const term = joined(conditions(block, "TERMS"), "and");
      return term && { kind: "not", term };
    }
    default:
      return joined(conditions(block, "TERMS"), "and");
  }
}

/** The meaning of a statement as a text to compare: without places, and as blocks would say it. */
export function fingerprint(statement: Statement): string {
  const comments = statement.comments?.length ? statement.comments.join("\n") : null;
  switch (statement.kind) {
    case "raw":
      return JSON.stringify(["raw", statement.text]);
    case "set":
      return JSON.stringify([...setPrint(statement), comments]);
    case "keep":
      return JSON.stringify(["keep", statement.topic, statement.hz, comments]);
    case "rule":
      return JSON.stringify([
        "rule",
        statement.name,
        statement.priority,
        conditionPrint(statement.condition),
        statement.then.map(setPrint),
        statement.else.map(setPrint),
        comments,
      ]);
  }
}

function setPrint(set: SetStatement): unknown[] {
  return ["set", set.topic, rateText(set.rate)];
}

function conditionPrint(condition: Condition): unknown {
  if (condition.kind === "check") return [condition.topic, condition.property, condition.op, condition.value];
  if (condition.kind === "not") return ["not", conditionPrint(condition.term)];
  const [only, ...others] = condition.terms;
  return only && others.length === 0 ? conditionPrint(only) : [condition.kind, ...condition.terms.map(conditionPrint)];
}
