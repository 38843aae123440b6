// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { Action, PlacedCollection, RuleStatement, SetStatement } from "../../src/api/types";
import { actedOn } from "../../src/blocks/rule_acts";

const then: Action[] = [];
const NOTHING = { then, else: [] };
const rule = (id: string): RuleStatement => ({
  kind: "rule",
  id,
  comments: ["why"],
  condition: { kind: "check", topic: "/odom", property: "speed", op: ">", value: 1 },
  ...NOTHING,
});
const DEFAULT: SetStatement = { kind: "set", id: "s1", topic: "/odom", rate: { kind: "full", value: null } };
const FIRST = { id: "c1", statements: [DEFAULT, rule("s2")] } as PlacedCollection;
const SECOND = { id: "c2", statements: [rule("s3")] } as PlacedCollection;
const ALL = [FIRST, SECOND].flatMap((collection) =>
  collection.statements.map((statement, index) => ({ statement, collection, index })),
);

test("a rule moves among the statements of its collection", () => {
  expect(actedOn(ALL, 1, "up")).toEqual({ edit: { kind: "move", id: "s2", collection: "c1", index: 0 }, at: 0 });
  expect(actedOn(ALL, 1, "down")).toBeNull();
  expect(actedOn(ALL, 2, "up")).toBeNull();
});

test("a switched rule keeps its comments and its place", () => {
  const done = actedOn(ALL, 2, "switch");
  expect(done).toMatchObject({ edit: { id: "s3", statement: { is_disabled: true, comments: null } }, at: 2 });
});

test("only rules are acted on", () => {
  expect(actedOn(ALL, 0, "duplicate")).toBeNull();
  expect(actedOn(ALL, 1, "duplicate")).toEqual({ edit: { kind: "duplicate", id: "s2" }, at: 2 });
});
