// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Truth } from "../api/types";
import { readable } from "../ui/numbers";
import type { TimePart } from "./conditions";
import type { CheckState, TimeState } from "./live_states";

const CHECK_WORDS = { true: "✓ true", false: "✗ false", unknown: "? unknown" };
export const RULE_WORDS = { true: "✓ holds", false: "✗ does not hold", unknown: "? unknown" };
const SIGNS: Record<Truth, string> = { true: "✓", false: "✗", unknown: "?" };
const IN_MS_BELOW_S = 1;
const IN_MIN_FROM_S = 120;

/** What a badge says of a check, with the value that it reads. */
export function checkWords({ state, value }: CheckState, unit: string): string {
  const shown = value === null ? "" : ` ${readable(value)}${unit && ` ${unit}`}`;
  return `${CHECK_WORDS[state]}${shown}`;
}

/** What a badge says of a time: how much of it is over, as in `holds for 6 s of 10 s`. */
export function timeWords({ state, held_s }: TimeState, { word, duration }: TimePart): string {
  const whole = `${duration.value} ${duration.unit}`;
  if (held_s === null) return `${SIGNS[state]} not known for ${whole} yet`;
  if (word === "For") {
    if (held_s === 0) return `${SIGNS[state]} does not hold now`;
    return `${SIGNS[state]} holds for ${spell(held_s)}${state === "true" ? "" : ` of ${whole}`}`;
  }
  if (held_s === 0) return `${SIGNS[state]} holds now`;
  if (state === "true") return `${SIGNS[state]} held ${spell(held_s)} ago`;
  return state === "false" ? `${SIGNS[state]} not in the last ${whole}` : `${SIGNS[state]} not for ${spell(held_s)}`;
}

function spell(seconds: number): string {
  if (seconds < IN_MS_BELOW_S) return `${Math.round(seconds * 1000)} ms`;
  if (seconds < IN_MIN_FROM_S) return `${Math.floor(seconds)} s`;
  return `${readable(Math.floor(seconds / 60))} min`;
}
