// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, signal } from "@preact/signals";

const MOST_STEPS = 500;
const MOST_LETTERS = 50_000_000;
const TYPING_PAUSE_MS = 800;

/** Undo over everything: a stack of texts. Letters typed in one go are one step. */
export class History {
  private readonly past = signal<readonly string[]>([]);
  private readonly future = signal<readonly string[]>([]);
  private lastTypedMs = Number.NEGATIVE_INFINITY;

  readonly canUndo = computed(() => this.past.value.length > 0);
  readonly canRedo = computed(() => this.future.value.length > 0);

  /** Remembers the text before a change; `typedMs` is the time of a key stroke. */
  push(before: string, typedMs: number | null = null): void {
    const goesOn = typedMs !== null && typedMs - this.lastTypedMs < TYPING_PAUSE_MS;
    this.lastTypedMs = typedMs ?? Number.NEGATIVE_INFINITY;
    if (!(goesOn && this.canUndo.value)) this.past.value = newest([...this.past.value, before]);
    this.future.value = [];
  }

  /** The text to go back to, or null. */
  undo(current: string): string | null {
    return this.step(this.past, this.future, current);
  }

  /** The text to go forward to, or null. */
  redo(current: string): string | null {
    return this.step(this.future, this.past, current);
  }

  private step(from: typeof this.past, to: typeof this.past, current: string): string | null {
    const text = from.value.at(-1);
    if (text === undefined) return null;
    from.value = from.value.slice(0, -1);
    to.value = [...to.value, current];
    this.lastTypedMs = Number.NEGATIVE_INFINITY;
    return text;
  }
}

/** The last texts, as many as fit into memory. */
function newest(texts: readonly string[]): readonly string[] {
  let letters = 0;
  const dropped = texts.findLastIndex((text, index) => {
    letters += text.length;
    return letters > MOST_LETTERS || index < texts.length - MOST_STEPS;
  });
  return texts.slice(Math.min(dropped + 1, texts.length - 1));
}
