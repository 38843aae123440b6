// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { Action, DurationUnit, DurationValue, MarginValue, Rate, SetStatement } from "../api/types";
import { parseBound, parseRate, parseTopics, rateText, topicsText } from "./rule_words";

type State = Blockly.serialization.blocks.State;

/** What blocks call the kinds of actions. */
const TYPES: Readonly<Record<Action["kind"], string>> = {
  set: "adirf_set",
  within: "adirf_within",
  record: "adirf_record",
  parameter: "adirf_parameter",
  call: "adirf_call",
  notify: "adirf_notify",
};
/** The blocks that stand in THEN and ELSE. */
export const ACTION_TYPES: ReadonlySet<string> = new Set(Object.values(TYPES));
/** The blocks of THEN and ELSE that outside rules are defaults, which hang together. */
export const DEFAULT_TYPES: ReadonlySet<string> = new Set(["adirf_set", "adirf_within"]);

/** What a block of a rate keeps beside its fields: whether a value says how much of the rate holds. */
export interface MarginState {
  hasMargin?: boolean;
}

/** A part of THEN or ELSE as a block to load. */
export function actionBlock(action: Action): State {
  const type = TYPES[action.kind];
  switch (action.kind) {
    case "set": {
      const { margin } = action;
      const fields = { TOPIC: action.topic, RATE: rateText(action.rate) };
      if (!margin) return { type, fields };
      return { type, extraState: { hasMargin: true }, fields: { ...fields, ...marginFields(margin) } };
    }
    case "within":
      return { type, fields: { TOPIC: action.topic, PROPERTY: action.property, BOUND: String(action.bound) } };
    case "record":
      return {
        type,
        fields: {
          NAME: action.name,
          TOPICS: topicsText(action.topics),
          BEFORE: action.before.value,
          BEFORE_UNIT: action.before.unit,
          AFTER: action.after.value,
          AFTER_UNIT: action.after.unit,
        },
      };
    case "parameter":
      return { type, fields: { NODE: action.node, PARAMETER: action.parameter, VALUE: action.value } };
    case "call":
      return { type, fields: { SERVICE: action.service, ARGUMENT: String(action.argument ?? "") } };
    case "notify":
      return { type, fields: { TEXT: action.text } };
  }
}

/** The values of the fields of a margin, by name. */
export function marginFields({ to, topic, property, from_value, to_value }: MarginValue): Record<string, unknown> {
  return { TO_RATE: rateText(to), BY_TOPIC: topic, BY_PROPERTY: property, FROM: from_value, TO: to_value };
}

/** What a block of THEN or ELSE says; null for a block of another kind. */
export function toAction(block: Blockly.Block): Action | null {
  const text = (name: string) => String(block.getFieldValue(name));
  switch (block.type) {
    case TYPES.set:
      return toSet(block);
    case TYPES.within:
      return {
        kind: "within",
        topic: text("TOPIC"),
        property: text("PROPERTY"),
        bound: parseBound(text("BOUND")) ?? 0,
      };
    case TYPES.record:
      return {
        kind: "record",
        name: text("NAME"),
        topics: parseTopics(text("TOPICS")),
        before: durationOf(block, "BEFORE", "BEFORE_UNIT"),
        after: durationOf(block, "AFTER", "AFTER_UNIT"),
      };
    case TYPES.parameter:
      return { kind: "parameter", node: text("NODE"), parameter: text("PARAMETER"), value: text("VALUE") };
    case TYPES.call: {
      const argument = text("ARGUMENT");
      return { kind: "call", service: text("SERVICE"), argument: argument === "" ? null : argument === "true" };
    }
    case TYPES.notify:
      return { kind: "notify", text: text("TEXT") };
    default:
      return null;
  }
}

function toSet(block: Blockly.Block): SetStatement {
  const set: SetStatement = { kind: "set", topic: String(block.getFieldValue("TOPIC")), rate: rateOf(block, "RATE") };
  if (!block.getField("TO_RATE")) return set;
  const margin: MarginValue = {
    to: rateOf(block, "TO_RATE"),
    topic: String(block.getFieldValue("BY_TOPIC")),
    property: String(block.getFieldValue("BY_PROPERTY")),
    from_value: Number(block.getFieldValue("FROM")),
    to_value: Number(block.getFieldValue("TO")),
  };
  return { ...set, margin };
}

function rateOf(block: Blockly.Block, field: string): Rate {
  return parseRate(String(block.getFieldValue(field))) ?? { kind: "full", value: null };
}

/** The time that two fields of a block say. */
export function durationOf(block: Blockly.Block, value: string, unit: string): DurationValue {
  return { value: Number(block.getFieldValue(value)), unit: block.getFieldValue(unit) as DurationUnit };
}

/** The meaning of an action, to compare. */
export function actionPrint(action: Action): unknown[] {
  switch (action.kind) {
    case "set": {
      const { margin } = action;
      return ["set", action.topic, rateText(action.rate), ...(margin ? Object.values(marginFields(margin)) : [])];
    }
    case "within":
      return ["within", action.topic, action.property, action.bound];
    case "record":
      return ["record", action.name, action.topics, durationPrint(action.before), durationPrint(action.after)];
    case "parameter":
      return ["parameter", action.node, action.parameter, action.value];
    case "call":
      return ["call", action.service, action.argument ?? null];
    case "notify":
      return ["notify", action.text];
  }
}

export function durationPrint({ value, unit }: DurationValue): string {
  return `${value} ${unit}`;
}
