// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type { CheckCondition, Condition, DurationValue, Operator, TimedCondition, TimeWord } from "../api/types";
import { durationOf, durationPrint } from "./actions";

type State = Blockly.serialization.blocks.State;

/** What a block of a condition says of time, beside its fields. */
export interface ClockState {
  times?: number;
  hasUntil?: boolean;
}
/** One `For` or `Within` behind a condition. */
export interface TimePart {
  word: TimeWord;
  duration: DurationValue;
}

/** Conditions below each other, which all hold, as blocks to load. */
export function conditionStack(condition: Condition): State {
  return stack(terms(condition).map(conditionBlock));
}

/** A stack of checks means that all of them hold, so an AND is the stack of its terms. */
function terms(condition: Condition): Condition[] {
  return condition.kind === "and" ? condition.terms : [condition];
}

function conditionBlock(condition: Condition): State {
  const { core, times } = untimed(condition);
  const block = coreBlock(core);
  const until = core.kind === "check" ? (core.until ?? null) : null;
  if (times.length === 0 && until === null) return block;
  const extraState: ClockState = {
    ...(times.length > 0 ? { times: times.length } : {}),
    ...(until ? { hasUntil: true } : {}),
  };
  const fields = Object.assign({}, block.fields, until && { UNTIL_OP: until.op, UNTIL_VALUE: until.value });
  times.forEach((part, at) => {
    Object.assign(fields, timeFields(part, at));
  });
  return { ...block, extraState, fields };
}

/** The values of the fields of one time, by name. */
export function timeFields({ word, duration }: TimePart, at: number): Record<string, unknown> {
  return { [`WORD${at}`]: word, [`LENGTH${at}`]: duration.value, [`TIME_UNIT${at}`]: duration.unit };
}

/** A condition without its times, and these from the innermost. */
function untimed(condition: Condition): { core: Exclude<Condition, TimedCondition>; times: TimePart[] } {
  if (condition.kind !== "timed") return { core: condition, times: [] };
  const { core, times } = untimed(condition.term);
  return { core, times: [...times, condition] };
}

function coreBlock(condition: Exclude<Condition, TimedCondition>): State {
  switch (condition.kind) {
    case "check":
      return {
        type: "adirf_check",
        fields: { TOPIC: condition.topic, PROPERTY: condition.property, OP: condition.op, VALUE: condition.value },
      };
    case "and":
      return { type: "adirf_all", inputs: { TERMS: { block: stack(condition.terms.map(conditionBlock)) } } };
    case "or":
      return { type: "adirf_any", inputs: { TERMS: { block: stack(condition.terms.map(conditionBlock)) } } };
    case "not":
      return { type: "adirf_not", inputs: { TERMS: { block: conditionStack(condition.term) } } };
  }
}

export function stack(blocks: State[]): State {
  return blocks.reduceRight((below, block) => ({ ...block, next: { block: below } }));
}

/** The blocks below each other in a part of another block. */
export function stacked(block: Blockly.Block, input: string): Blockly.Block[] {
  const blocks: Blockly.Block[] = [];
  let next = block.getInputTargetBlock(input);
  while (next) {
    if (!next.isInsertionMarker()) blocks.push(next);
    next = next.getNextBlock();
  }
  return blocks;
}

/** What the checks in a part of a block say together; null where there are none. */
export function conditionIn(block: Blockly.Block, input: string): Condition | null {
  return joined(conditions(block, input), "and");
}

function conditions(block: Blockly.Block, input: string): Condition[] {
  return stacked(block, input)
    .map(toCondition)
    .filter((each) => each !== null);
}

function joined(all: Condition[], kind: "and" | "or"): Condition | null {
  return all.length > 1 ? { kind, terms: all } : (all[0] ?? null);
}

/** What a block of a condition says, with its times; null for an `any of` with nothing inside. */
export function toCondition(block: Blockly.Block): Condition | null {
  const core = toCore(block);
  return core && timesOn(block).reduce<Condition>((term, part) => ({ kind: "timed", term, ...part }), core);
}

/** The times behind the condition of a block, from the innermost. */
export function timesOn(block: Blockly.Block): TimePart[] {
  const times: TimePart[] = [];
  for (let at = 0; block.getField(`WORD${at}`); at++) {
    const word = block.getFieldValue(`WORD${at}`) as TimeWord;
    times.push({ word, duration: durationOf(block, `LENGTH${at}`, `TIME_UNIT${at}`) });
  }
  return times;
}

function toCore(block: Blockly.Block): Condition | null {
  switch (block.type) {
    case "adirf_check":
      return toCheck(block);
    case "adirf_any":
      return joined(conditions(block, "TERMS"), "or");
    case "adirf_not": {
      const term = conditionIn(block, "TERMS");
      return term && { kind: "not", term };
    }
    default:
      return conditionIn(block, "TERMS");
  }
}

function toCheck(block: Blockly.Block): CheckCondition {
  const check: CheckCondition = {
    kind: "check",
    topic: String(block.getFieldValue("TOPIC")),
    property: String(block.getFieldValue("PROPERTY")),
    op: block.getFieldValue("OP") as Operator,
    value: Number(block.getFieldValue("VALUE")),
  };
  if (!block.getField("UNTIL_OP")) return check;
  const until = { op: block.getFieldValue("UNTIL_OP") as Operator, value: Number(block.getFieldValue("UNTIL_VALUE")) };
  return { ...check, until };
}

/** The meaning of a condition, to compare. */
export function conditionPrint(condition: Condition): unknown {
  switch (condition.kind) {
    case "check": {
      const { topic, property, op, value, until } = condition;
      return [topic, property, op, value, ...(until ? [until.op, until.value] : [])];
    }
    case "not":
      return ["not", conditionPrint(condition.term)];
    case "timed":
      return [condition.word, durationPrint(condition.duration), conditionPrint(condition.term)];
    default: {
      const [only, ...others] = condition.terms;
      return only && others.length === 0
        ? conditionPrint(only)
        : [condition.kind, ...condition.terms.map(conditionPrint)];
    }
  }
}
