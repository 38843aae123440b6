// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Statement } from "../api/types";

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
