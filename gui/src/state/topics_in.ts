// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Condition, RuleDocument } from "../api/types";

/** Every topic that the rules set, bound, record or check. */
export function topicsIn(document: Pick<RuleDocument, "collections">): ReadonlySet<string> {
  const topics = new Set<string>();
  for (const { statements } of document.collections) {
    for (const statement of statements) {
      if (statement.kind === "raw") continue;
      if (statement.kind !== "rule") topics.add(statement.topic);
      else {
        addChecked(statement.condition, topics);
        for (const action of [...statement.then, ...statement.else]) {
          for (const topic of action.kind === "record" ? action.topics : [action.topic]) topics.add(topic);
        }
      }
    }
  }
  return topics;
}

function addChecked(condition: Condition, topics: Set<string>): void {
  if (condition.kind === "check") topics.add(condition.topic);
  else if (condition.kind === "not" || condition.kind === "timed") addChecked(condition.term, topics);
  else for (const term of condition.terms) addChecked(term, topics);
}
