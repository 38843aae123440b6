// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Bound, TIERS } from "../api/types";
import { numberProblemOr, typedNumber } from "../ui/numbers";

/** What somebody typed as a bound: a number or a level's name in any case of letters; null where it is none. */
export function parseBound(text: string): Bound | null {
  const word = text.trim();
  const tier = TIERS.find((each) => each.toLowerCase() === word.toLowerCase());
  if (tier !== undefined) return tier;
  const bound = typedNumber(word);
  return Number.isFinite(bound) && bound >= 0 ? bound : null;
}

/** Why a text is no bound, in words; empty where it is one. */
export function boundProblem(text: string): string {
  if (parseBound(text) !== null) return "";
  return numberProblemOr(text, "A bound is a number or a quality level");
}
