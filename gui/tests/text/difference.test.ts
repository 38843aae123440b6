// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { describe, expect, test } from "vitest";
import { difference, differingLines } from "../../src/text/difference";

/** All texts of up to `most` of these letters. */
function texts(letters: readonly string[], most: number): string[] {
  if (most === 0) return [""];
  const shorter = texts(letters, most - 1);
  const longest = shorter.filter((text) => text.length === most - 1);
  return [...shorter, ...longest.flatMap((text) => letters.map((letter) => text + letter))];
}

const PAIRS = texts(["a", "b", "\n"], 4).flatMap((a) => texts(["a", "\n"], 4).map((b) => [a, b] as const));

describe("the difference of two texts", () => {
  test("leaves out all that they share at both ends, and nothing twice", () => {
    for (const [a, b] of PAIRS) {
      const { from, tail } = difference(a, b);
      const shorter = Math.min(a.length, b.length);
      expect(from + tail).toBeLessThanOrEqual(shorter);
      expect(a.slice(0, from)).toBe(b.slice(0, from));
      expect(a.slice(a.length - tail)).toBe(b.slice(b.length - tail));
      if (from + tail < shorter) {
        expect(a[from]).not.toBe(b[from]);
        expect(a.at(-tail - 1)).not.toBe(b.at(-tail - 1));
      }
    }
  });

  test("is found to the letter in long texts", () => {
    const [head, end] = ["x".repeat(10_001), "y".repeat(9_999)];
    expect(difference(`${head}1${end}`, `${head}22${end}`)).toEqual({ from: 10_001, tail: 9_999 });
  });
});

describe("the lines in which two texts differ", () => {
  test("are whole, and put in place of each other make one text the other", () => {
    for (const [a, b] of PAIRS) {
      const lines = differingLines(a, b);
      const before = a
        .split("\n")
        .slice(0, lines.line - 1)
        .map((line) => `${line}\n`)
        .join("");
      expect(a.startsWith(before + lines.a)).toBe(true);
      const behind = a.slice(before.length + lines.a.length);
      expect(before + lines.b + behind).toBe(b);
      const isWhole = (part: string) => behind === "" || behind.startsWith("\n") || part === "" || part.endsWith("\n");
      expect([a, b, isWhole(lines.a) && isWhole(lines.b)]).toEqual([a, b, true]);
    }
  });

  test("are counted from 1", () => {
    expect(differingLines("begin\n  one\nend\n", "begin\n  two\nend\n")).toMatchObject({ line: 2 });
    expect(differingLines("one\n", "two\n")).toMatchObject({ line: 1 });
  });
});
