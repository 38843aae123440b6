// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Action, RuleStatement, Statement } from "../api/types";
import { checksOf } from "../state/statements";
import { rateText } from "./field_text";

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

/** What a rule is called, or when it holds. */
export function ruleName({ name, condition }: RuleStatement): string {
  if (name) return name;
  const [first, ...others] = checksOf(condition);
  const words = first ? `if ${first.topic} ${first.property} ${first.op} ${first.value}` : "if";
  return others.length > 0 ? `${words} …` : words;
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

/** A statement in a few words, for lists. */
export function statementTitle(statement: Statement): string {
  switch (statement.kind) {
    case "set": {
      const unit = statement.rate.kind === "hz" ? " Hz" : "";
      return `${statement.topic} at ${rateText(statement.rate)}${unit}`;
    }
    case "keep":
      return `keep ${statement.topic} at least at ${statement.hz} Hz`;
    case "within":
      return `keep ${statement.topic} ${statement.property} within ${statement.bound}`;
    case "rule":
      return `Rule ${statement.name ?? statement.label ?? `in line ${statement.line ?? ""}`}`;
    case "raw":
      return statement.text.split(/\r?\n/, 1)[0] ?? "";
  }
}
