// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** The tops of stacks with these heights, one below the other; a pinned stack keeps its top, else the first starts at `first`. */
export function topsOf(
  heights: readonly number[],
  gap: number,
  first: number,
  pin: { index: number; top: number } | null = null,
): number[] {
  let y = 0;
  const tops = heights.map((height) => {
    const top = y;
    y += height + gap;
    return top;
  });
  const start = pin === null ? first : pin.top - (tops[pin.index] ?? 0);
  return tops.map((top) => start + top);
}

/** The things of the text in its order, and each other thing behind what it stood behind. */
export function withLoose<T>(text: readonly T[], before: readonly T[]): T[] {
  const order = [...text];
  const known = new Set(text);
  before.forEach((each, index) => {
    if (known.has(each)) return;
    known.add(each);
    const above = before.slice(0, index).findLast((other) => known.has(other));
    order.splice(above === undefined ? 0 : order.indexOf(above) + 1, 0, each);
  });
  return order;
}

/** The place of what is dropped with its upper edge at `y`, among things that are one below the other. */
export function dropIndex(things: readonly { top: number; height: number }[], y: number): number {
  const below = things.findIndex(({ top, height }) => y < top + height / 2);
  return below < 0 ? things.length : below;
}

/** Neighbours that hang together, in stacks; one that begins something hangs on nothing above it. */
export function stacksOf<T>(
  order: readonly T[],
  hangs: (thing: T) => boolean,
  begins: (thing: T) => boolean = () => false,
): T[][] {
  const stacks: T[][] = [];
  order.forEach((each, index) => {
    const above = order[index - 1];
    if (above !== undefined && hangs(above) && hangs(each) && !begins(each)) stacks.at(-1)?.push(each);
    else stacks.push([each]);
  });
  return stacks;
}
