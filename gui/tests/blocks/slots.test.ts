// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { Edit, KeepStatement, PlacedCollection, Statement } from "../../src/api/types";
import { edited } from "../../src/blocks/slots";

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
