// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { CheckCondition, RuleDocument, SetStatement, Statement } from "../../src/api/types";
import { sectionsOf, topicsIn } from "../../src/state/statements";

const check = (topic: string): CheckCondition => ({ kind: "check", topic, property: "rate", op: ">", value: 1 });
const set = (topic: string): SetStatement => ({ kind: "set", topic, rate: { kind: "full", value: null } });

function documentOf(...statements: Statement[]): Pick<RuleDocument, "collections"> {
  return { collections: [{ id: "c", is_written: true, offset: 0, end_offset: 0, line: 1, comments: [], statements }] };
}

test("a topic counts where rules set it, keep it or check it, however deep", () => {
  const document = documentOf(
    set("/default"),
    { kind: "keep", topic: "/floor", hz: 1 },
    {
      kind: "rule",
      name: null,
      priority: 0,
      condition: {
        kind: "and",
        terms: [check("/first"), { kind: "not", term: { kind: "or", terms: [check("/deep"), check("/first")] } }],
      },
      // biome-ignore lint/suspicious/noThenProperty: a rule's THEN, never awaited
      then: [set("/then"), { kind: "within", topic: "/bound", property: "x", bound: 1 }],
      else: [set("/else")],
    },
  );
  expect([...topicsIn(document)].sort()).toEqual(["/bound", "/deep", "/default", "/else", "/first", "/floor", "/then"]);
});

test("text that is no rule yet names no topic", () => {
  expect(topicsIn(documentOf({ kind: "raw", text: "SetFrequency /odom" })).size).toBe(0);
});

/** The sections of a text whose statements are its lines that begin with "Set". */
function sections(text: string): Record<number, string> {
  const statements = [...text.matchAll(/^ *(Set\S+)/gm)].map(({ index, 0: line, 1: words = "" }) => ({
    offset: index + line.length - words.length,
    end_offset: index + line.length,
  }));
  return Object.fromEntries(sectionsOf(text, statements as Statement[]));
}

test("a comment that stands alone heads what comes next", () => {
  const text = `// The file.

begin
    // ---- Defaults ----

    SetA
    SetB // of B
    // of C
    SetC

    // Hall 2,
    // upper floor

    // of D
    SetD
end
`;
  expect(sections(text)).toEqual({ 0: "Defaults", 3: "Hall 2, upper floor" });
});

test("of two comments that stand alone the nearer one is the heading", () => {
  expect(sections("begin\r\n // A\r\n\r\n // B\r\n\r\n SetA\r\nend\r\n")).toEqual({ 0: "B" });
});
