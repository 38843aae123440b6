// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { PlacedFinding, Severity, Statement } from "../api/types";

const SEVERITIES: readonly Severity[] = ["error", "warning", "info"];

/** Findings in the order in which they matter, else in that of the text. */
export function worstFirst(findings: readonly PlacedFinding[]): PlacedFinding[] {
  const rank = ({ severity }: PlacedFinding) => SEVERITIES.indexOf(severity);
  return findings.toSorted((one, other) => rank(one) - rank(other));
}

/** Statements that are as a click put them there, to be changed. */
export class Placeholders {
  /** By their keys, which come from their words: one that somebody changed has another. */
  private readonly keys: ReadonlySet<string | undefined>;
  private readonly found: ReadonlySet<string>;

  /** What came with the click into the statements `before`, of which `found` was told. */
  constructor(
    before: readonly Statement[],
    found: readonly PlacedFinding[],
    after: readonly Statement[],
    earlier: Placeholders | null,
  ) {
    const known = new Set(before.map(({ key }) => key));
    const brought = after.flatMap(({ key }) => (known.has(key) ? [] : [key]));
    this.keys = new Set([...(earlier?.keys ?? []), ...brought]);
    this.found = new Set(found.map(wordsOf));
  }

  /** Whether there would be no such finding without them. */
  bring(finding: PlacedFinding, byId: ReadonlyMap<string, Statement>): boolean {
    const isAbout = [finding.statement, ...finding.related].some((id) => this.keys.has(byId.get(id ?? "")?.key));
    return isAbout && !this.found.has(wordsOf(finding));
  }
}

function wordsOf({ code, message }: PlacedFinding): string {
  return `${code} ${message}`;
}
