// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { numberProblem } from "../ui/numbers";
import { type DraftRow, isNumber, TIER_COUNT } from "./profile_editor";

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
    const given = row.tiers_hz.filter((tier) => tier.trim() !== "").length;
    if (given !== 0 && given !== TIER_COUNT) problems.push(`${place}: give all six levels, or none.`);
  }
  const names = rows.map((row) => row.topic.trim()).filter(Boolean);
  for (const name of new Set(names)) {
    if (names.filter((each) => each === name).length > 1) problems.push(`${name} is in two rows.`);
  }
  return problems;
}
