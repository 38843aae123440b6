// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
const STEP = 4096;

/** How many code units two texts share at their start and, behind these, at their end. */
export function difference(a: string, b: string): { from: number; tail: number } {
  const shorter = Math.min(a.length, b.length);
  let from = 0;
  // Whole stretches first: a letter at a time takes long in a large file.
  while (from + STEP <= shorter && a.slice(from, from + STEP) === b.slice(from, from + STEP)) from += STEP;
  while (from < shorter && a[from] === b[from]) from++;
  const rest = shorter - from;
  let tail = 0;
  const end = (text: string, length: number) => text.slice(text.length - tail - length, text.length - tail);
  while (tail + STEP <= rest && end(a, STEP) === end(b, STEP)) tail += STEP;
  while (tail < rest && end(a, 1) === end(b, 1)) tail++;
  return { from, tail };
}

/** The whole lines from the first to the last in which two texts differ; `line` counts from 1. */
export function differingLines(a: string, b: string): { line: number; a: string; b: string } {
  const { from, tail } = difference(a, b);
  const start = from === 0 ? 0 : a.lastIndexOf("\n", from - 1) + 1;
  const isWholeLines = [a, b].every((text) => [undefined, "\n"].includes(text[text.length - tail - 1]));
  const lineEnd = a.indexOf("\n", a.length - tail);
  const same = isWholeLines ? tail : lineEnd < 0 ? 0 : a.length - lineEnd;
  return {
    line: a.slice(0, start).split("\n").length,
    a: a.slice(start, a.length - same),
    b: b.slice(start, b.length - same),
  };
}
