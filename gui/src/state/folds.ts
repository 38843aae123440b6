// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Statement } from "../api/types";

/** Rules of a text with more than this many begin folded. */
const MANY_RULES = 20;

/** Which rules of a file are folded to one line, for as long as the page is open. */
export class Folds {
  /** What somebody chose, by the key of the statement. */
  private readonly chosen = new Map<string, boolean>();
  private usual: boolean | null = null;

  isFolded({ kind, key = "" }: Statement): boolean {
    return kind === "rule" && (this.chosen.get(key) ?? this.usual ?? false);
  }

  set(statement: Statement, isFolded: boolean): void {
    this.chosen.set(statement.key ?? "", isFolded);
  }

  setAll(isFolded: boolean): void {
    this.chosen.clear();
    this.usual = isFolded;
  }

  /** Goes on with a text that changed: rules whose words changed stay as they are, and new ones are open. */
  follow(before: readonly Statement[], after: readonly Statement[]): void {
    if (this.usual === null || before.length === 0) {
      this.usual ??= after.filter(({ kind }) => kind === "rule").length > MANY_RULES;
      return;
    }
    const known = new Set(before.map(({ key }) => key));
    const isSameCount = before.length === after.length;
    after.forEach((statement, index) => {
      const old = before[index];
      if (!known.has(statement.key)) this.set(statement, isSameCount && old !== undefined && this.isFolded(old));
    });
  }
}
