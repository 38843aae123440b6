// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type ReadonlySignal } from "@preact/signals";
import type { Conflict } from "./conflict";
import type { Restored } from "./drafts";

const AFTER_MS = 2000;
const AGAIN_AFTER_MS = 10_000;

/** A file that can be saved without being asked. */
export interface SelfSaving {
  /** Another value with each key stroke. */
  readonly content: ReadonlySignal<unknown>;
  readonly isSaved: ReadonlySignal<boolean>;
  readonly conflict: ReadonlySignal<Conflict | null>;
  readonly restored: ReadonlySignal<Restored | null>;
  /** Whether what is there now is worth a save: nobody wants half a rule in a file. */
  isSound(): boolean | Promise<boolean>;
  /** Saves it; a refusal is told, and leaves it unsaved. */
  save(): Promise<void>;
}

/**
 * Saves a file two seconds after its last change; what is there when the returned function is called, at once.
 *
 * After a conflict it waits for a person: until the file was saved, it asks no second time.
 */
export function saveByItself(file: SelfSaving): () => void {
  let timer: number | undefined;
  let isHeld = false;
  let isSaving = false;
  const mayNot = () => isHeld || isSaving || file.isSaved.peek() || file.restored.peek()?.isContested === true;
  const saveNow = async () => {
    if (mayNot()) return;
    isSaving = true;
    const content = file.content.peek();
    try {
      if (await file.isSound()) await file.save();
    } finally {
      isSaving = false;
    }
    // A key stroke may have come meanwhile; else the server may be there again by then.
    wait(content === file.content.peek() ? AGAIN_AFTER_MS : AFTER_MS);
  };
  const wait = (ms: number) => {
    window.clearTimeout(timer);
    timer = mayNot() ? undefined : window.setTimeout(() => void saveNow(), ms);
  };
  const stops = [
    effect(() => {
      if (file.conflict.value !== null) isHeld = true;
      else if (file.isSaved.value) isHeld = false;
    }),
    effect(() => {
      void [file.content.value, file.isSaved.value, file.restored.value];
      wait(AFTER_MS);
    }),
  ];
  return () => {
    for (const stop of stops) stop();
    if (timer === undefined) return;
    window.clearTimeout(timer);
    if (!mayNot()) void Promise.resolve(file.isSound()).then((isSound) => (isSound ? file.save() : undefined));
  };
}
