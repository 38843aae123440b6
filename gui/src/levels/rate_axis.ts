// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** A stretch of rates in Hz, as the logarithm of which a plot shows them. */
export interface RateAxis {
  low_hz: number;
  high_hz: number;
}

const MARGIN = 1.5;
const USUAL: RateAxis = { low_hz: 0.1, high_hz: 100 };

/** The axis that shows all of `rates_hz`, with room on both sides; 0 lies at its left end. */
export function axisOf(rates_hz: readonly number[]): RateAxis {
  const positive = rates_hz.filter((each) => each > 0);
  if (positive.length === 0) return USUAL;
  return { low_hz: Math.min(...positive) / MARGIN, high_hz: Math.max(...positive) * MARGIN };
}

/** Where a rate lies on the axis, 0 … 1. */
export function shareOf({ low_hz, high_hz }: RateAxis, rate_hz: number): number {
  const share = Math.log(Math.max(rate_hz, low_hz) / low_hz) / Math.log(high_hz / low_hz);
  return Math.min(Math.max(share, 0), 1);
}

export function rateAt({ low_hz, high_hz }: RateAxis, share: number): number {
  return low_hz * (high_hz / low_hz) ** Math.min(Math.max(share, 0), 1);
}

/** How far one key stroke moves a rate: a tenth of its power of ten. */
export function stepOf(rate_hz: number): number {
  return rate_hz > 0 ? 10 ** (Math.floor(Math.log10(rate_hz) + 1e-9) - 1) : 0.1;
}

/** A rate in round numbers: two digits. */
export function roundRate(rate_hz: number): number {
  return Number(rate_hz.toPrecision(2));
}

/** The same levels with level `index` at `rate_hz`, or at its neighbour where it would pass that. */
export function moved(
  levels_hz: readonly number[],
  index: number,
  rate_hz: number,
): { levels_hz: number[]; stoppedBy: number | null } {
  const [least, most] = limitsOf(levels_hz, index);
  const stoppedBy = rate_hz < least && index > 0 ? index - 1 : rate_hz > most ? index + 1 : null;
  return { levels_hz: levels_hz.with(index, Math.min(Math.max(rate_hz, least), most)), stoppedBy };
}

/** The rates between which level `index` may lie: its neighbours. */
export function limitsOf(levels_hz: readonly number[], index: number): [least_hz: number, most_hz: number] {
  return [levels_hz[index - 1] ?? 0, levels_hz[index + 1] ?? HIGHEST_HZ];
}

const HIGHEST_HZ = 1e6;
