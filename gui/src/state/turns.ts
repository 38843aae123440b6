// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Truth } from "../api/types";
import { durationWords } from "../ui/numbers";
import { upTo } from "./timeline";

export type Turns = readonly (readonly [number, Truth])[];

/** What something was at a time; unknown before its first turn. */
export function truthAt(turns: Turns, timeS: number): Truth {
  return turns[upTo(turns, ([t]) => t <= timeS) - 1]?.[1] ?? "unknown";
}

/** From when to when something was true, false or unknown, in s; one ends where the next begins. */
interface Stretch {
  truth: Truth;
  fromS: number;
  toS: number;
}

/** The stretches between turns, of which none is empty. */
export function stretches(turns: Turns, durationS: number): Stretch[] {
  return turns
    .map(([fromS, truth], index) => ({ truth, fromS, toS: Math.min(turns[index + 1]?.[0] ?? durationS, durationS) }))
    .filter(({ fromS, toS }) => toS > fromS);
}

/** `Holds for 3 s of 8 s, in 2 stretches; unknown for 0.1 s`. */
export function holdsWords(turns: Turns, durationS: number): string {
  const all = stretches(turns, durationS);
  const seconds = (truth: Truth) =>
    all.filter((one) => one.truth === truth).reduce((sum, { fromS, toS }) => sum + toS - fromS, 0);
  const held = all.filter(({ truth }) => truth === "true").length;
  const often = held > 1 ? `, in ${held} stretches` : "";
  const unknownS = seconds("unknown");
  const unknown = unknownS > 0 ? `; unknown for ${durationWords(unknownS)}` : "";
  const holds =
    held === 0 ? "Never holds" : `Holds for ${durationWords(seconds("true"))} of ${durationWords(durationS)}`;
  return `${holds}${often}${unknown}`;
}
