// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Action, RuleStatement } from "../api/types";
import { rateText } from "./rate_text";

/** What an action does, in the fewest words. */
export function actionWords(action: Action): string {
  switch (action.kind) {
    case "set":
      return `${action.topic} ${rateText(action.rate)}${action.rate.kind === "hz" ? " Hz" : ""}`;
    case "within":
      return `${action.topic} ${action.property} ${action.bound}`;
    case "record":
      return `record ${[action.name, ...action.topics].join(" ")}`;
  }
}

export function ruleName({ name, label, line }: RuleStatement): string {
  return name ?? label ?? `rule in line ${line ?? ""}`;
}

/** What a rule sets, in at most about so many letters. */
export function ruleSets({ then, else: otherwise }: RuleStatement, mostLetters: number): string {
  const all = [...then.map(actionWords), ...otherwise.map((action) => `else ${actionWords(action)}`)];
  let count = 1;
  while (count < all.length && all.slice(0, count + 1).join(", ").length <= mostLetters) count++;
  const more = all.length - count;
  const shown = all.slice(0, count).join(", ");
  const cut = shown.length > mostLetters ? `${shown.slice(0, mostLetters - 1)}…` : shown;
  return more > 0 ? `${cut} and ${more} more` : cut;
}
