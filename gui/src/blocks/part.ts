// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
/** A text with no more statements than this is shown whole: Blockly keeps every block drawn. */
const WHOLE = 40;

/** The statements that are blocks now, of a longer text those near the view; counted from 0 in the order of the text. */
export interface Part {
  readonly first: number;
  readonly count: number;
  readonly total: number;
}

export function partAround(index: number, total: number): Part {
  if (total <= WHOLE) return { first: 0, count: total, total };
  const first = Math.max(0, Math.min(index - WHOLE / 4, total - WHOLE / 2));
  return { first, count: Math.min(WHOLE / 2, total - first), total };
}

/** The same part of a text that changed, by the keys of its statements: what comes or goes in it makes it longer or shorter. */
export function follow(part: Part, before: readonly string[], after: readonly string[]): Part {
  const total = after.length;
  if (total <= WHOLE || part.total === 0) return partAround(0, total);
  const more = total - part.total;
  const changed = before.findIndex((key, index) => key !== after[index]);
  const at = changed < 0 ? before.length : changed;
  const first = at < part.first ? part.first + more : part.first;
  const isIn = at >= part.first && at <= part.first + part.count;
  const count = isIn ? part.count + more : part.count;
  const isPart = first >= 0 && count > 0 && first + count <= total;
  return isPart ? { first, count, total } : partAround(Math.min(at, total - 1), total);
}

/** The tops of rows with these heights, the end of the last one included. */
export function offsetsOf(heights: readonly number[]): number[] {
  let y = 0;
  return [0, ...heights.map((height) => (y += height))];
}

/** The rows that a stretch of the column needs; of a short text all. */
export function partAt(offsets: readonly number[], top: number, bottom: number): Part {
  const total = offsets.length - 1;
  if (total <= WHOLE) return { first: 0, count: total, total };
  const above = offsets.findLastIndex((y) => y <= top);
  const below = offsets.findIndex((y) => y >= bottom);
  const first = Math.min(Math.max(above, 0), total - 1);
  const last = below < 0 ? total : Math.max(below, first + 1);
  return { first, count: last - first, total };
}

export function covers(part: Part, other: Part): boolean {
  return part.first <= other.first && other.first + other.count <= part.first + part.count;
}

/** The statements of a part. */
export function inPart<T>(all: readonly T[], { first, count }: Part): T[] {
  return all.slice(first, first + count);
}
