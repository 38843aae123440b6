// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Action, CheckCondition, Condition, RuleDocument, Statement } from "../api/types";

/** Every topic that the rules set, bound, record or check. */
export function topicsIn(document: Pick<RuleDocument, "collections">): ReadonlySet<string> {
  const topics = new Set<string>();
  for (const { statements } of document.collections) {
    for (const statement of statements) {
      if (statement.kind === "raw") continue;
      if (statement.kind !== "rule") topics.add(statement.topic);
      else {
        for (const { topic } of checksOf(statement.condition)) topics.add(topic);
        for (const action of [...statement.then, ...statement.else]) {
          for (const topic of action.kind === "record" ? action.topics : [action.topic]) topics.add(topic);
        }
      }
    }
  }
  return topics;
}

/** Whether a rate or a bound of the rules is a quality level. */
export function namesLevel({ collections }: Pick<RuleDocument, "collections">): boolean {
  const isLevel = (one: Statement | Action) =>
    (one.kind === "set" && one.rate.kind === "tier") || (one.kind === "within" && typeof one.bound === "string");
  return statementsIn({ collections }).some((one) =>
    one.kind === "rule" ? [...one.then, ...one.else].some(isLevel) : isLevel(one),
  );
}

/** All checks of a condition in the order of the text. */
export function checksOf(condition: Condition): CheckCondition[] {
  if (condition.kind === "check") return [condition];
  if (condition.kind === "not" || condition.kind === "timed") return checksOf(condition.term);
  return condition.terms.flatMap(checksOf);
}

/** All statements of a document in the order of the text. */
export function statementsIn({ collections }: Pick<RuleDocument, "collections">): Statement[] {
  return collections.flatMap(({ statements }) => statements);
}

/** The words of comments that stand alone, by the number of the statement that comes next: its section begins there. */
export function sectionsOf(text: string, statements: readonly Statement[]): ReadonlyMap<number, string> {
  const sections = new Map<number, string>();
  let from = 0;
  statements.forEach(({ offset, end_offset }, index) => {
    const title = titleIn(text.slice(from, offset ?? from));
    if (title !== "") sections.set(index, title);
    from = end_offset ?? from;
  });
  return sections;
}

/** The last comment between two statements with an empty line behind it: what is directly above a statement is its own. */
function titleIn(between: string): string {
  if (!between.includes("//")) return "";
  let title: string[] = [];
  let comment: string[] = [];
  // The first line belongs to what stands before, the last one to what comes.
  for (const line of between.split("\n").slice(1, -1)) {
    const words = line.trim();
    if (words.startsWith("//")) {
      comment.push(words);
      continue;
    }
    if (/^(begin|end)\b/i.test(words)) title = [];
    else if (words === "" && comment.length > 0) title = comment;
    comment = [];
  }
  return title
    .map((line) => line.replace(/^[/\s=*-]+|[\s=*-]+$/g, ""))
    .join(" ")
    .trim();
}
