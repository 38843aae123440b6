// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type * as Blockly from "blockly/core";
import type {
  Action,
  CheckCondition,
  Condition,
  DurationValue,
  Operator,
  RuleStatement,
  SetStatement,
  Statement,
  TimedCondition,
  TimeWord,
  WithinStatement,
} from "../api/types";
import { actionBlock, actionPrint, durationOf, durationPrint, toAction } from "./action_model";
import { comparedIn } from "./compared";
import { checksIn, INSIDE, rectangleOf, withZones, ZONE_CHECKS, zoneText } from "./zones";

type State = Blockly.serialization.blocks.State;

/** A rule that is folded to one line. */
export const FOLDED = "adirf_folded";

/** A rule on one line: its name, whether it is switched off, and what it sets. */
export interface FoldedRule extends Blockly.BlockSvg {
  readonly rule: RuleStatement;
  isSwitchedOff(): boolean;
}

/** A rule block grows an ELSE part when asked, and says whether its rule is switched off. */
export interface RuleBlock extends Blockly.BlockSvg {
  setElse(shown: boolean): void;
  isSwitchedOff(): boolean;
  switchOff(isOff: boolean): void;
}

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
      return { ...(toAction(block) as SetStatement | WithinStatement), comments };
    case "adirf_keep":
      return { kind: "keep", topic: text("TOPIC"), hz: Number(text("HZ")), comments };
    case "adirf_rule": {
      const condition = conditionIn(block, "IF");
      if (condition === null) return { missing: "IF needs a check" };
      const then = actions(block, "THEN");
      if (then.length === 0) return { missing: "THEN needs a rate, a bound, a recording or an action" };
      if (block.getInput("ELSE") && actions(block, "ELSE").length === 0) {
        return { missing: "ELSE needs a rate, a bound, a recording or an action" };
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

/** What a block of a condition says of time, beside its fields. */
export interface ClockState {
  times?: number;
  hasUntil?: boolean;
}
/** A `For` or `Within` behind a condition. */
export interface TimePart {
  word: TimeWord;
  duration: DurationValue;
}

/** Conditions below each other, which all hold, as blocks to load. */
function conditionStack(condition: Condition): State {
  return stack(zoneBlocks(terms(condition)));
}

/** The terms of an AND as blocks, those that bound a zone as one. */
function zoneBlocks(terms: readonly Condition[]): State[] {
  return withZones(terms).map((each) => (Array.isArray(each) ? insideBlock(each) : conditionBlock(each)));
}

function insideBlock(checks: readonly CheckCondition[]): State {
  return { type: INSIDE, fields: { ZONE: zoneText(checks) } };
}

/** The checks of a zone as blocks to load. */
export function checkStack(checks: readonly CheckCondition[]): State {
  return stack(checks.map((each) => conditionBlock(each)));
}

/** A stack of checks means that all of them hold, so an AND is the stack of its terms. */
function terms(condition: Condition): Condition[] {
  return condition.kind === "and" ? condition.terms : [condition];
}

/** Below another one an AND of a zone is `all of` it, as its parentheses are in the text. */
function conditionBlock(condition: Condition, isInOr = false): State {
  const { core, times } = untimed(condition);
  const isAlone = core.kind === "and" && core.terms.length === ZONE_CHECKS && (isInOr || times.length > 0);
  const isZone = isAlone && rectangleOf(core.terms) !== null;
  const block = isZone ? insideBlock(core.terms as CheckCondition[]) : coreBlock(core);
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
      return { type: "adirf_all", inputs: { TERMS: { block: stack(zoneBlocks(condition.terms)) } } };
    case "or":
      return {
        type: "adirf_any",
        inputs: { TERMS: { block: stack(condition.terms.map((term) => conditionBlock(term, true))) } },
      };
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
function conditionIn(block: Blockly.Block, input: string): Condition | null {
  return joined(conditions(block, input), "and");
}

/** What the blocks in a part say; a zone without a time says its checks. */
function conditions(block: Blockly.Block, input: string): Condition[] {
  return stacked(block, input).flatMap((each) => {
    const condition = toCondition(each);
    if (condition === null) return [];
    return each.type === INSIDE && condition.kind === "and" ? condition.terms : [condition];
  });
}

/** What the block of a zone stands for: its four checks, or what is made of them. */
export function insideChecks(block: Blockly.Block): Condition[] {
  return block.getInput("TERMS") ? conditions(block, "TERMS") : checksIn(String(block.getFieldValue("ZONE")));
}

function joined(all: Condition[], kind: "and" | "or"): Condition | null {
  return all.length > 1 ? { kind, terms: all } : (all[0] ?? null);
}

/** How many checks of the text a block alone stands for. */
export function checksOn(block: Blockly.Block): number {
  if (block.type === INSIDE) return block.getInput("TERMS") ? 0 : ZONE_CHECKS;
  return block.type === "adirf_check" ? 1 : 0;
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
    case INSIDE:
      return joined(insideChecks(block), "and");
    case "adirf_any": {
      const terms = stacked(block, "TERMS").map(toCondition);
      return joined(
        terms.filter((each) => each !== null),
        "or",
      );
    }
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
    value: comparedIn(block.getFieldValue("VALUE")),
  };
  if (!block.getField("UNTIL_OP")) return check;
  const value = comparedIn(block.getFieldValue("UNTIL_VALUE"));
  const until = { op: block.getFieldValue("UNTIL_OP") as Operator, value };
  return { ...check, until };
}

/** The meaning of a condition, to compare. */
function conditionPrint(condition: Condition): unknown {
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
