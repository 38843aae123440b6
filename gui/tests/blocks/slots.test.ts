// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type {
  Action,
  Edit,
  KeepStatement,
  PlacedCollection,
  RuleStatement,
  SetStatement,
  Statement,
} from "../../src/api/types";
import { actedOn, edited } from "../../src/blocks/slots";

const keep = (topic: string, id = ""): KeepStatement => ({ kind: "keep", topic, hz: 1, id });

function collection(id: string, ...statements: Statement[]): PlacedCollection {
  return { id, is_written: true, offset: 0, end_offset: 0, line: 1, comments: [], statements };
}

const BEFORE = [
  collection("c1", keep("/a", "s1"), { ...keep("/b", "s2"), comments: ["why"] }),
  collection("c2", keep("/c", "s3")),
];

test.each<[Edit, string[][]]>([
  [{ kind: "delete", id: "s1" }, [["s1 /b"], ["s2 /c"]]],
  [
    { kind: "insert", collection: "c2", index: 0, statement: keep("/d") },
    [
      ["s1 /a", "s2 /b"],
      ["s3 /d", "s4 /c"],
    ],
  ],
  [{ kind: "move", id: "s1", collection: "c1", index: 1 }, [["s1 /b", "s2 /a"], ["s3 /c"]]],
  [{ kind: "move", id: "s3", collection: "c1", index: 1 }, [["s1 /a", "s2 /c", "s3 /b"], []]],
  [{ kind: "replace", id: "s3", statement: keep("/d") }, [["s1 /a", "s2 /b"], ["s3 /d"]]],
])("%o leaves the statements numbered as the server does", (edit, after) => {
  const said = edited(BEFORE, edit).map(({ statements }) =>
    statements.map((each) => `${each.id} ${"topic" in each ? each.topic : ""}`),
  );
  expect(said).toEqual(after);
  expect(BEFORE.map(({ statements }) => statements.length)).toEqual([2, 1]);
});

test("a replaced statement keeps its comments unless others are said", () => {
  const commentsOf = (comments: string[] | null) =>
    edited(BEFORE, { kind: "replace", id: "s2", statement: { ...keep("/b"), comments } })[0]?.statements[1]?.comments;
  expect(commentsOf(null)).toEqual(["why"]);
  expect(commentsOf([])).toEqual([]);
});

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
