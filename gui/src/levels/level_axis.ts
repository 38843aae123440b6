// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { TIERS } from "../api/types";
import { readable } from "../ui/numbers";

/** A stretch of rates or bounds, as the logarithm of which a plot shows them. */
export interface LevelAxis {
  low: number;
  high: number;
}

/** What levels are of: their unit, and the values that they may have; bounds fall from level to level, rates rise. */
export interface LevelKind {
  unit: string;
  falls: boolean;
  least: number;
  most: number;
}

export const RATES: LevelKind = { unit: "Hz", falls: false, least: 0, most: 1e6 };
// Dragged lines stop at a millionth: smaller numbers have an exponent, which a screen reader does not take.
export const boundsIn = (unit: string): LevelKind => ({ unit, falls: true, least: 1e-6, most: 1e9 });

const MARGIN = 1.5;
const USUAL: LevelAxis = { low: 0.1, high: 100 };

/** The axis that shows all of `values`, with room on both sides; 0 lies at its left end. */
export function axisOf(values: readonly number[]): LevelAxis {
  const positive = values.filter((each) => each > 0);
  if (positive.length === 0) return USUAL;
  return { low: Math.min(...positive) / MARGIN, high: Math.max(...positive) * MARGIN };
}

/** Where a value lies on the axis, 0 … 1. */
export function shareOf({ low, high }: LevelAxis, value: number): number {
  const share = Math.log(Math.max(value, low) / low) / Math.log(high / low);
  return Math.min(Math.max(share, 0), 1);
}

export function valueAt({ low, high }: LevelAxis, share: number): number {
  return low * (high / low) ** Math.min(Math.max(share, 0), 1);
}

/** How far one key stroke moves a value: a tenth of its power of ten. */
export function stepOf(value: number): number {
  return value > 0 ? 10 ** (Math.floor(Math.log10(value) + 1e-9) - 1) : 0.1;
}

/** A value in round numbers: two digits. */
export function rounded(value: number): number {
  return Number(value.toPrecision(2));
}

/** The same levels with level `index` at `value`, or at its neighbour where it would pass that. */
export function moved(
  kind: LevelKind,
  levels: readonly number[],
  index: number,
  value: number,
): { levels: number[]; stoppedBy: number | null } {
  const [least, most] = limitsOf(kind, levels, index);
  const way = value < least ? -1 : value > most ? 1 : 0;
  const neighbour = index + (kind.falls ? -way : way);
  const stoppedBy = way !== 0 && neighbour in levels ? neighbour : null;
  return { levels: levels.with(index, Math.min(Math.max(value, least), most)), stoppedBy };
}

/** The values between which level `index` may lie: its neighbours. */
export function limitsOf(kind: LevelKind, levels: readonly number[], index: number): [least: number, most: number] {
  const [below, above] = kind.falls ? [index + 1, index - 1] : [index - 1, index + 1];
  return [levels[below] ?? kind.least, levels[above] ?? kind.most];
}

/** Why a moved level did not go on; empty where it did. */
export function stopped(kind: LevelKind, index: number, { levels, stoppedBy }: ReturnType<typeof moved>): string {
  if (stoppedBy === null) return "";
  const way = stoppedBy < index === kind.falls ? "above" : "below";
  const at = `${readable(levels[stoppedBy] ?? 0)} ${kind.unit}`;
  return `${TIERS[index]} stops at ${TIERS[stoppedBy]} (${at}): it cannot lie ${way} it.`;
}
