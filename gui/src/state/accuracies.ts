// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { LevelledProperty, LevelsAnswer, ProfileRow } from "../api/types";

export type Six = LevelsAnswer["tiers_hz"];
type TiersKey = "tiers_m" | "tiers_deg" | "tiers_rad";
type NeedsKey = `${TiersKey}_need_hz`;
/** The accuracies of a topic's levels and the rates that they need, by the profile's keys. */
export type Accuracies = Record<TiersKey | NeedsKey, Six | null>;

/** What can have levels of accuracy, with the unit of its key. */
export const ACCURACY_UNITS: Record<LevelledProperty, "m" | "deg" | "rad"> = {
  position: "m",
  orientation: "deg",
  positions: "rad",
};
const KEYS = Object.values(ACCURACY_UNITS).flatMap((unit) => keysOf(unit));

export function keysOf(unit: "m" | "deg" | "rad"): [tiers: TiersKey, needs: NeedsKey] {
  return [`tiers_${unit}`, `tiers_${unit}_need_hz`];
}

export function accuraciesOf(row: Partial<ProfileRow>): Accuracies {
  return Object.fromEntries(KEYS.map((key) => [key, row[key] ?? null])) as Accuracies;
}

/** Whether `value`, of a draft that was kept, can be edited as accuracies. */
export function areAccuracies(value: unknown): value is Accuracies {
  if (typeof value !== "object" || value === null) return false;
  const given = value as Record<string, unknown>;
  return KEYS.every((key) => given[key] === null || isSix(given[key]));
}

function isSix(value: unknown): boolean {
  return Array.isArray(value) && value.length === 6 && value.every((each) => typeof each === "number");
}

export function sixOf([a, b, c, d, e, f]: readonly (number | null)[]): Six | null {
  const isWhole = a != null && b != null && c != null && d != null && e != null && f != null;
  return isWhole ? [a, b, c, d, e, f] : null;
}
