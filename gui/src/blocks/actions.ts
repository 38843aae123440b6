// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Action, DurationUnit, DurationValue, SetStatement } from "../api/types";
import { parseBound, parseRate, parseTopics, rateText, topicsText } from "./rule_words";

type State = Blockly.serialization.blocks.State;

/** The blocks that stand in THEN and ELSE. */
export const ACTION_TYPES: ReadonlySet<string> = new Set(["adirf_set", "adirf_within", "adirf_record"]);
/** Those of them that are defaults outside rules, where they hang together. */
export const DEFAULT_TYPES: ReadonlySet<string> = new Set(["adirf_set", "adirf_within"]);

/** A part of THEN or ELSE as a block to load. */
export function actionBlock(action: Action): State {
  switch (action.kind) {
    case "set":
      return { type: "adirf_set", fields: { TOPIC: action.topic, RATE: rateText(action.rate) } };
    case "within":
      return {
        type: "adirf_within",
        fields: { TOPIC: action.topic, PROPERTY: action.property, BOUND: String(action.bound) },
      };
    case "record":
      return {
        type: "adirf_record",
        fields: {
          NAME: action.name,
          TOPICS: topicsText(action.topics),
          BEFORE: action.before.value,
          BEFORE_UNIT: action.before.unit,
          AFTER: action.after.value,
          AFTER_UNIT: action.after.unit,
        },
      };
  }
}

/** What a block of THEN or ELSE says; null for a block of another kind. */
export function toAction(block: Blockly.Block): Action | null {
  const text = (name: string) => String(block.getFieldValue(name));
  switch (block.type) {
    case "adirf_set":
      return setStatement(block);
    case "adirf_within":
      return {
        kind: "within",
        topic: text("TOPIC"),
        property: text("PROPERTY"),
        bound: parseBound(text("BOUND")) ?? 0,
      };
    case "adirf_record":
      return {
        kind: "record",
        name: text("NAME"),
        topics: parseTopics(text("TOPICS")),
        before: durationOf(block, "BEFORE", "BEFORE_UNIT"),
        after: durationOf(block, "AFTER", "AFTER_UNIT"),
      };
    default:
      return null;
  }
}

function setStatement(block: Blockly.Block): SetStatement {
  const rate = parseRate(String(block.getFieldValue("RATE"))) ?? { kind: "full", value: null };
  return { kind: "set", topic: String(block.getFieldValue("TOPIC")), rate };
}

/** The time that two fields of a block say. */
export function durationOf(block: Blockly.Block, value: string, unit: string): DurationValue {
  return { value: Number(block.getFieldValue(value)), unit: block.getFieldValue(unit) as DurationUnit };
}

/** The meaning of an action, to compare. */
export function actionPrint(action: Action): unknown[] {
  switch (action.kind) {
    case "set":
      return ["set", action.topic, rateText(action.rate)];
    case "within":
      return ["within", action.topic, action.property, action.bound];
    case "record":
      return ["record", action.name, action.topics, durationPrint(action.before), durationPrint(action.after)];
  }
}

export function durationPrint({ value, unit }: DurationValue): string {
  return `${value} ${unit}`;
}
