// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Action, Statement } from "../api/types";
import { actionBlock, actionPrint, toAction } from "./actions";
import type { RuleBlock } from "./block_types";
import { conditionIn, conditionPrint, conditionStack, stack, stacked } from "./conditions";
import { FOLDED, type FoldedRule } from "./folded_type";

type State = Blockly.serialization.blocks.State;

/** A statement as a block to load; a rule may be folded to one line. */
export function toBlock(statement: Statement, isFolded = false): State {
  const icons = statement.comments?.length ? { icons: { comment: { text: statement.comments.join("\n") } } } : {};
  if (isFolded) return { type: FOLDED, extraState: { rule: statement }, ...icons };
  return { ...statementBlock(statement), ...icons };
}

function statementBlock(statement: Statement): State {
  switch (statement.kind) {
    case "set":
    case "within":
      return actionBlock(statement);
    case "keep":
      return { type: "adirf_keep", fields: { TOPIC: statement.topic, HZ: statement.hz } };
    case "raw":
      return { type: "adirf_raw" };
    case "rule": {
      const inputs: NonNullable<State["inputs"]> = {
        IF: { block: conditionStack(statement.condition) },
        THEN: { block: stack(statement.then.map(actionBlock)) },
      };
      if (statement.else.length > 0) inputs.ELSE = { block: stack(statement.else.map(actionBlock)) };
      const extraState = {
        ...(statement.else.length > 0 ? { hasElse: true } : {}),
        ...(statement.is_disabled ? { isOff: true } : {}),
      };
      return {
        type: "adirf_rule",
        fields: { NAME: statement.name ?? "", PRIORITY: statement.priority },
        inputs,
        ...(Object.keys(extraState).length > 0 ? { extraState } : {}),
      };
    }
  }
}

/** The statement that a block says, or why it says none yet. */
export function toStatement(block: Blockly.Block): Statement | { missing: string } {
  const comments = block.getCommentText()?.trim() ? (block.getCommentText()?.split("\n") ?? null) : null;
  const text = (name: string) => String(block.getFieldValue(name));
  switch (block.type) {
    case "adirf_set":
    case "adirf_within":
      return { ...(toAction(block) as Exclude<Action, { kind: "record" }>), comments };
    case "adirf_keep":
      return { kind: "keep", topic: text("TOPIC"), hz: Number(text("HZ")), comments };
    case "adirf_rule": {
      const condition = conditionIn(block, "IF");
      if (condition === null) return { missing: "IF needs a check" };
      const then = actions(block, "THEN");
      if (then.length === 0) return { missing: "THEN needs a rate, a bound or a recording" };
      if (block.getInput("ELSE") && actions(block, "ELSE").length === 0) {
        return { missing: "ELSE needs a rate, a bound or a recording" };
      }
      const name = text("NAME").trim() || null;
      const priority = name === null ? 0 : Number(text("PRIORITY"));
      const is_disabled = (block as RuleBlock).isSwitchedOff();
      return { kind: "rule", name, priority, is_disabled, condition, then, else: actions(block, "ELSE"), comments };
    }
    case FOLDED:
      return { ...(block as FoldedRule).rule, comments };
    default:
      return { missing: "This belongs in a rule" };
  }
}

function actions(block: Blockly.Block, input: string): Action[] {
  return stacked(block, input)
    .map(toAction)
    .filter((each) => each !== null);
}

/** The meaning of a statement as a text to compare: without places, and as blocks would say it. */
export function fingerprint(statement: Statement): string {
  const comments = statement.comments?.length ? statement.comments.join("\n") : null;
  switch (statement.kind) {
    case "raw":
      return JSON.stringify(["raw", statement.text]);
    case "set":
    case "within":
      return JSON.stringify([...actionPrint(statement), comments]);
    case "keep":
      return JSON.stringify(["keep", statement.topic, statement.hz, comments]);
    case "rule":
      return JSON.stringify([
        "rule",
        statement.name,
        statement.priority,
        statement.is_disabled ?? false,
        conditionPrint(statement.condition),
        statement.then.map(actionPrint),
        statement.else.map(actionPrint),
        comments,
      ]);
  }
}
