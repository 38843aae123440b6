// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { BoundNeed } from "../api/types";

const DIGITS = 3;

interface Need {
  hz: number;
  isMeasured: boolean;
}

/**
 * The messages per s that `bound` needs with hold; `points` are measured, the widest first.
 *
 * Between two bounds it is on the line between theirs, above the widest on that of it; null below the tightest.
 */
export function needOf(points: readonly BoundNeed[], bound: number): Need | null {
  for (const [index, point] of points.entries()) {
    if (bound === point.bound) return { hz: inRound(point.hold_hz), isMeasured: true };
    if (bound < point.bound) continue;
    const wider = points[index - 1];
    if (!wider) return { hz: inRound(point.hold_hz), isMeasured: false };
    const share = (bound - point.bound) / (wider.bound - point.bound);
    return { hz: inRound(point.hold_hz + (wider.hold_hz - point.hold_hz) * share), isMeasured: false };
  }
  return null;
}

function inRound(rate_hz: number): number {
  return Number(rate_hz.toPrecision(DIGITS));
}
