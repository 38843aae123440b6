// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect, test } from "vitest";
import type { Statement } from "../../src/api/types";
import { sectionsOf } from "../../src/state/statements";

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
