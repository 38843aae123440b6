// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from "@preact/signals";
import { counted } from "../ui/numbers";

/** What blocks said when they were left and the text does not say, in a few words each. */
export interface Lost {
  readonly name: string;
  readonly changes: readonly string[];
  readonly why: string;
}

/** Who has something that is on its way into a text, such as the blocks that are shown, or that were left. */
export class WorkAhead {
  private readonly those = signal<ReadonlySet<object>>(new Set());
  readonly isAny = computed(() => this.those.value.size > 0);

  tell(who: object, isAhead: boolean): void {
    const those = this.those.peek();
    if (those.has(who) === isAhead) return;
    this.those.value = new Set(isAhead ? [...those, who] : [...those].filter((each) => each !== who));
  }
}

/** What a saved file lacks, in words: blocks that say nothing that a text could say; empty for none. */
export function withoutBlocks(count: number): string {
  return count === 0 ? "" : ` without ${counted(count, "block")} that ${count === 1 ? "is" : "are"} not in the text`;
}
