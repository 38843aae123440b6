// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Placed } from "./slots";

/** How many statements of a long text are shown as blocks at once: Blockly keeps every block drawn. */
export const PAGE = 20;
/** A text with no more statements than this is shown whole. */
const WHOLE = 40;
const LARGEST = 2 * PAGE;

/** The statements that are shown as blocks, counted from 0 in the order of the text. */
export interface Pages {
  readonly first: number;
  readonly count: number;
  readonly total: number;
}

/** The page that holds a statement. */
export function pageAt(index: number, total: number): Pages {
  if (total <= WHOLE) return { first: 0, count: total, total };
  const first = Math.max(0, Math.min(index - (index % PAGE), total - 1));
  return { first, count: Math.min(PAGE, total - first), total };
}

/** The same page of a text that changed: what comes or goes on it makes it longer or shorter. */
export function follow(pages: Pages, before: readonly Placed[], after: readonly Placed[]): Pages {
  const { length } = after;
  const more = length - pages.total;
  if (length <= WHOLE || pages.total === 0) return pageAt(0, length);
  const changed = before.findIndex(({ statement }, index) => statement.key !== after[index]?.statement.key);
  const at = changed < 0 ? before.length : changed;
  const isAbove = at < pages.first;
  const isBelow = at > pages.first + pages.count;
  const first = isAbove ? pages.first + more : pages.first;
  const count = isAbove || isBelow ? pages.count : pages.count + more;
  const isWhole = first >= 0 && first + count <= length;
  return isWhole && count > 0 && count <= LARGEST
    ? { first, count, total: length }
    : pageAt(Math.min(at, length - 1), length);
}

/** The statements of a page. */
export function onPage<T>(all: readonly T[], { first, count }: Pages): T[] {
  return all.slice(first, first + count);
}

export function isSamePage(a: Pages, b: Pages): boolean {
  return a.first === b.first && a.count === b.count && a.total === b.total;
}
