// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Statement } from "../api/types";
import { DEFAULT_TYPES } from "./actions";
import { GAP, HEADING } from "./column";
import { checksOf } from "./live_states";
import { offsetsOf } from "./part";
import type { Slot } from "./slots";

/** The height of one line of a block, before any was drawn. */
const LINE = 48;

/** How much room statements need in the column, in the units of the canvas: as they were drawn, else about so much. */
export class Rows {
  private readonly drawn = new Map<string, number>();

  constructor(private readonly isFolded: (statement: Statement) => boolean) {}

  measure(statements: readonly Statement[], slots: readonly Slot[]): void {
    slots.forEach(({ block }, index) => {
      const statement = statements[index];
      if (statement && block.height > 0) this.drawn.set(this.look(statement), block.height);
    });
  }

  /** Where each statement begins below the top of the column, and where the last one ends. */
  offsets(statements: readonly Statement[], sections: ReadonlyMap<number, string>): number[] {
    return offsetsOf(
      statements.map((statement, index) => {
        const next = statements[index + 1];
        const hangs = next && isDefault(statement) && isDefault(next) && !sections.has(index + 1);
        const heading = sections.has(index + 1) ? HEADING : 0;
        return (this.drawn.get(this.look(statement)) ?? this.guess(statement)) + (hangs ? 0 : GAP) + heading;
      }),
    );
  }

  private look(statement: Statement): string {
    if (statement.kind !== "rule") return statement.kind;
    return this.isFolded(statement) ? "folded" : `${statement.key}`;
  }

  private guess(statement: Statement): number {
    if (statement.kind !== "rule" || this.isFolded(statement)) return LINE;
    const parts = checksOf(statement.condition).length + statement.then.length + statement.else.length;
    return LINE * (4 + parts);
  }
}

function isDefault({ kind }: Statement): boolean {
  return DEFAULT_TYPES.has(`adirf_${kind}`);
}
