// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { numberProblem, typedNumber } from "../ui/numbers";
import type { Accuracies } from "./accuracies";
import type { TypedRow } from "./pasted_table";

export const TIER_COUNT = 6;

/** One row as it is being typed: texts, since half a number is not a number yet. */
export interface DraftRow extends TypedRow {
  key: number;
  type: string | null;
  accuracies: Accuracies;
}
export type NumberField = "message_kb" | "priority" | "source_hz" | "min_hz" | "max_hz";

/** The number in a cell; null where it is empty, NaN where it is none. */
export const toNumber = (text: string) => (text.trim() === "" ? null : typedNumber(text));
/** Whether a cell holds a number that can be saved; an empty one is "not given". */
export const isNumber = (text: string) => {
  const value = toNumber(text);
  return value === null || (Number.isFinite(value) && value >= 0);
};

function cellProblem(cell: string): string {
  return numberProblem(cell) || `${cell.trim()} is less than 0`;
}

/** What keeps a table of topic parameters from being saved, in sentences. */
export function problemsOf(rows: readonly DraftRow[], budget: string): string[] {
  const problems = isNumber(budget) ? [] : [`The budget, the total bandwidth: ${cellProblem(budget)}.`];
  for (const row of rows) {
    const place = row.topic || "A row without a topic";
    const cells = [row.message_kb, row.priority, row.source_hz, row.min_hz, row.max_hz, ...row.tiers_hz];
    const wrong = cells.find((cell) => !isNumber(cell));
    if (wrong !== undefined) problems.push(`${place}: ${cellProblem(wrong)}.`);
    const isGiven = cells.some((cell) => cell.trim() !== "") || Object.values(row.accuracies).some(Boolean);
    if (row.topic.trim() === "" && isGiven) {
      problems.push("A row with numbers has no topic: name its topic, or remove it.");
    }
    const given = row.tiers_hz.filter((tier) => tier.trim() !== "").length;
    if (given !== 0 && given !== TIER_COUNT) problems.push(`${place}: give all six levels, or none.`);
  }
  const names = rows.map((row) => row.topic.trim()).filter(Boolean);
  for (const name of new Set(names)) {
    if (names.filter((each) => each === name).length > 1) problems.push(`${name} is in two rows.`);
  }
  return problems;
}
