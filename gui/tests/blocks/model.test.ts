// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";
import { beforeAll, expect, test } from "vitest";
import type {
  Action,
  CheckCondition,
  Compared,
  Condition,
  Operator,
  RuleStatement,
  Statement,
  TimedCondition,
} from "../../src/api/types";
import { type BlockButtons, defineBlocks } from "../../src/blocks/block_types";
import { showNumbers } from "../../src/blocks/inside_block";
import { fingerprint, toBlock, toStatement } from "../../src/blocks/model";
import { INSIDE } from "../../src/blocks/zones";

const CHECK: CheckCondition = { kind: "check", topic: "/battery_state", property: "level", op: "<", value: 20 };
const OTHER: CheckCondition = { ...CHECK, op: ">=", value: -0.5 };
const RATE: Action = { kind: "set", topic: "/odom", rate: { kind: "full", value: null } };

const held = (term: Condition, value = 10): TimedCondition => ({
  kind: "timed",
  term,
  word: "For",
  duration: { value, unit: "s" },
});
const lately = (term: Condition): TimedCondition => ({
  kind: "timed",
  term,
  word: "Within",
  duration: { value: 0.5, unit: "min" },
});
const rule = (condition: Condition, then: Action[] = [RATE], other: Action[] = []): RuleStatement => ({
  kind: "rule",
  name: "Low",
  priority: 2,
  condition,
  then,
  else: other,
});

beforeAll(() => {
  const nothing = () => [];
  const suggest = {
    topics: nothing,
    topicChoices: nothing,
    patternChoices: nothing,
    vitalsChoices: nothing,
    properties: nothing,
    bounds: nothing,
    rates: nothing,
    boundLevels: nothing,
    words: nothing,
    allowed: nothing,
    unit: () => "",
    unknown: () => "",
    zones: nothing,
    drawValues: () => null,
  };
  const ignore = () => undefined;
  const buttons: BlockButtons = {
    addCheck: ignore,
    addRate: ignore,
    addBound: ignore,
    addRecord: ignore,
    addAct: ignore,
    toggleElse: ignore,
    toggleFold: ignore,
    remove: ignore,
    act: ignore,
    drawZone: ignore,
  };
  defineBlocks(suggest, buttons);
});

/** What the blocks of a statement say. */
function said(statement: Statement): Statement | { missing: string } {
  const workspace = new Blockly.Workspace();
  return toStatement(Blockly.serialization.blocks.append(toBlock(statement), workspace));
}

const ENDED: CheckCondition = { ...CHECK, until: { op: ">", value: 25 } };
const BOTH: Condition = { kind: "and", terms: [CHECK, OTHER] };
const EITHER: Condition = { kind: "or", terms: [CHECK, held(OTHER)] };
const CONDITIONS: [string, Condition][] = [
  ["a check for a time", held(CHECK)],
  ["a check with an end", ENDED],
  ["a check with an end for a time", held(ENDED)],
  ["times around times", lately(held(held(CHECK), 3))],
  ["both for a time", held(BOTH)],
  ["one of both for a time, lately", lately(held(EITHER))],
  ["not for a time", { kind: "not", term: held(CHECK) }],
  ["not both for a time", { kind: "not", term: held(BOTH) }],
  ["for a time not", held({ kind: "not", term: BOTH })],
  ["both, one for a time", { kind: "and", terms: [held(CHECK), lately(EITHER)] }],
];

const side = (property: string, op: Operator, value: Compared): CheckCondition => {
  return { kind: "check", topic: "/odom", property, op, value };
};
const SIDES = [side("pose_y", ">=", 1), side("pose_y", "<", 5.4), side("pose_x", ">", -13), side("pose_x", "<=", 6)];
const ZONE: Condition = { kind: "and", terms: SIDES };
const ZONES: [string, Condition, number][] = [
  ["a zone", ZONE, 1],
  ["a zone among checks", { kind: "and", terms: [CHECK, ...SIDES, OTHER] }, 1],
  ["a zone in parentheses", { kind: "and", terms: [ZONE, CHECK] }, 1],
  ["one of two zones", { kind: "or", terms: [ZONE, ZONE, CHECK] }, 2],
  ["two zones in a row", { kind: "and", terms: [...SIDES, ...SIDES] }, 2],
  ["not in a zone", { kind: "not", term: ZONE }, 1],
  ["a zone for a time", held(ZONE), 1],
  ["a zone for a time and a check", { kind: "and", terms: [lately(held(ZONE)), CHECK] }, 1],
  ["three sides", { kind: "and", terms: SIDES.slice(1) }, 0],
  ["sides between which nothing is", { kind: "and", terms: [side("pose_y", ">", 7), ...SIDES.slice(1)] }, 0],
  [
    "sides of two topics",
    { kind: "and", terms: [{ ...(SIDES[0] as CheckCondition), topic: "/x" }, ...SIDES.slice(1)] },
    0,
  ],
  ["a side for a time", { kind: "and", terms: [held(SIDES[0] as CheckCondition), ...SIDES.slice(1)] }, 0],
];

test.each(ZONES)("%s is said as in the text, with zones as one part each", (_, condition, count) => {
  const statement = rule(condition);
  const workspace = new Blockly.Workspace();
  const block = Blockly.serialization.blocks.append(toBlock(statement), workspace);
  expect(fingerprint(toStatement(block) as Statement)).toBe(fingerprint(statement));
  expect(block.getDescendants(true).filter(({ type }) => type === INSIDE)).toHaveLength(count);
});

test("a zone whose numbers are shown says the same, also once it is copied", () => {
  const statement = rule(held(ZONE));
  const workspace = new Blockly.Workspace();
  const block = Blockly.serialization.blocks.append(toBlock(statement), workspace);
  const zone = block.getDescendants(true).find(({ type }) => type === INSIDE) as Blockly.BlockSvg;
  const say = (of: Blockly.Block) => fingerprint(toStatement(of) as Statement);
  for (const isShown of [true, false]) {
    showNumbers(zone, isShown);
    expect(zone.getDescendants(true)).toHaveLength(isShown ? 5 : 1);
    expect(say(block)).toBe(fingerprint(statement));
    const copy = Blockly.serialization.blocks.save(block) as Blockly.serialization.blocks.State;
    expect(say(Blockly.serialization.blocks.append(copy, new Blockly.Workspace()))).toBe(fingerprint(statement));
  }
});

const COMPARED: Compared[] = [
  '"docking"',
  '"a \\"b\\" \\\\ c"',
  "true",
  "false",
  "ERROR",
  "DiagnosticStatus.ERROR",
  -0.5,
];

test.each(COMPARED)("blocks compare with %s as the text does", (value) => {
  const check: CheckCondition = { ...CHECK, topic: "/mode", property: 'status["lidar front"].level', op: "=", value };
  const ended: CheckCondition = { ...check, until: { op: "!=", value } };
  for (const statement of [rule(check), rule(held(ended))]) expect(said(statement)).toMatchObject(statement);
});

const ACTIONS: Action[] = [
  { kind: "parameter", node: "/controller_server", parameter: "FollowPath.max_vel_x", value: "1.0" },
  { kind: "parameter", node: "/controller_server", parameter: "mode", value: '"slow, please"' },
  { kind: "call", service: "/light", argument: true },
  { kind: "call", service: "/light", argument: false },
  { kind: "call", service: "/stop", argument: null },
  { kind: "notify", text: 'Lidar says "no"' },
  {
    kind: "set",
    topic: "/scan",
    rate: { kind: "tier", value: "Marginal" },
    margin: {
      to: { kind: "hz", value: 20 },
      topic: "@link",
      property: "round_trip",
      from_value: 300,
      to_value: 0.5,
    },
  },
  { kind: "set", topic: "/camera/**", rate: { kind: "off", value: null } },
];

test.each(ACTIONS)("blocks do %j as the text does", (action) => {
  expect(said(rule(CHECK, [action], [action]))).toMatchObject(rule(CHECK, [action], [action]));
  if (action.kind === "set") expect(said(action)).toMatchObject(action);
});

test("what differs in an action makes another rule of it", () => {
  const prints = ACTIONS.map((action) => fingerprint(rule(CHECK, [action])));
  expect(new Set(prints).size).toBe(ACTIONS.length);
});

test.each(CONDITIONS)("blocks say %s as the text does", (_, condition) => {
  const statement = rule(condition);
  expect(fingerprint(said(statement) as Statement)).toBe(fingerprint(statement));
});

test("a rule that is switched off says so, and is another rule", () => {
  const on = rule(CHECK, [RATE], [RATE]);
  const off: RuleStatement = { ...on, is_disabled: true };
  expect(said(off)).toMatchObject({ is_disabled: true, name: "Low" });
  expect(fingerprint(said(off) as Statement)).toBe(fingerprint(off));
  expect(said(on)).toMatchObject({ is_disabled: false });
  expect(fingerprint(on)).not.toBe(fingerprint(off));
});

test("whether not stands before or behind a time is another rule", () => {
  const inside = rule({ kind: "not", term: held(CHECK) });
  const outside = rule(held({ kind: "not", term: CHECK }));
  expect(fingerprint(inside)).not.toBe(fingerprint(outside));
  expect(toBlock(inside)).not.toEqual(toBlock(outside));
});

const BOUND: Statement & Action = { kind: "within", topic: "/odom", property: "position", bound: 0.05 };
const LEVEL: Statement & Action = { ...BOUND, bound: "Acceptable" };
const RECORD: Action = {
  kind: "record",
  name: 'a "near" miss',
  topics: ["/scan", "imu"],
  before: { value: 30, unit: "s" },
  after: { value: 500, unit: "ms" },
};
const OF_ALL: Action = { ...RECORD, topics: [] };

test.each<[string, Statement]>([
  ["a bound", BOUND],
  ["a bound with a level's name", LEVEL],
  ["a rule that bounds and records", rule(CHECK, [RECORD, RATE, LEVEL, OF_ALL, BOUND])],
  ["a rule that records in ELSE alone", rule(CHECK, [BOUND], [OF_ALL])],
])("blocks say %s as the text does", (_, statement) => {
  expect(fingerprint(said(statement) as Statement)).toBe(fingerprint(statement));
});

test("a recording outside a rule is not a statement", () => {
  const workspace = new Blockly.Workspace();
  const block = Blockly.serialization.blocks.append({ type: "adirf_record" }, workspace);
  expect(toStatement(block)).toEqual({ missing: "This belongs in a rule" });
});
