// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal } from "@preact/signals";
import { type Draft, type DraftKind, type Drafts, NO_ROOM, type Restored } from "./drafts";

/** A draft is written no more often than this: writing a long file takes longer than drawing a letter. */
const WRITE_AFTER_MS = 400;

/** A file that is being changed, as its draft needs it. */
interface Unsaved {
  readonly name: string;
  readonly restored: Signal<Restored | null>;
  readonly message: Signal<string>;
  /** Makes the draft of now, null while the file holds all; reads each signal that changes the draft. */
  draft(): (() => Draft) | null;
}

/** Keeps what is not saved of a file in this browser, a moment after it changed or when the page is left. */
export function keepDraft(drafts: Drafts, kind: DraftKind, file: Unsaved): void {
  let due: { write: () => void; timer: number } | null = null;
  const settle = () => {
    if (due === null) return;
    clearTimeout(due.timer);
    const { write } = due;
    due = null;
    write();
  };
  // A key that comes meanwhile is more urgent.
  const settleIdle = () => {
    if ("requestIdleCallback" in globalThis) requestIdleCallback(settle, { timeout: WRITE_AFTER_MS });
    else settle();
  };
  effect(() => {
    const draft = file.draft();
    const write = () => {
      if (draft !== null && !drafts.keep(kind, file.name, draft())) file.message.value = NO_ROOM;
    };
    if (draft !== null) {
      due = { write, timer: due?.timer ?? setTimeout(settleIdle, WRITE_AFTER_MS) };
      return;
    }
    if (due !== null) clearTimeout(due.timer);
    due = null;
    drafts.drop(kind, file.name);
    file.restored.value = null;
  });
  addEventListener("pagehide", settle);
}
