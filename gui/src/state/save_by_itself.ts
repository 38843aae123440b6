// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import type { OpenFile } from "./open_file";

const AFTER_MS = 2000;
const AGAIN_AFTER_MS = 10_000;

type SelfSaving = Pick<OpenFile, "whole" | "isInFile" | "conflict" | "restored" | "diskChange" | "isSound">;

/**
 * Saves a file two seconds after its last change; what is there when the returned function is called, at once.
 *
 * After a conflict it waits for a person: until the file was saved, it asks no second time.
 */
export function saveByItself(file: SelfSaving, save: () => Promise<void>): () => void {
  let timer: number | undefined;
  let isHeld = false;
  let isSaving = false;
  // Who removed a file does not want it back by itself.
  const isContested = () => file.restored.peek()?.isContested === true || file.diskChange.peek() === "gone";
  const mayNot = () => isHeld || isSaving || file.isInFile.peek() || isContested();
  const saveNow = async () => {
    if (mayNot()) return;
    isSaving = true;
    const whole = file.whole.peek();
    try {
      if (await file.isSound()) await save();
    } finally {
      isSaving = false;
    }
    // A key stroke may have come meanwhile; else the server may be there again by then.
    wait(whole === file.whole.peek() ? AGAIN_AFTER_MS : AFTER_MS);
  };
  const wait = (ms: number) => {
    window.clearTimeout(timer);
    timer = mayNot() ? undefined : window.setTimeout(() => void saveNow(), ms);
  };
  const stops = [
    effect(() => {
      if (file.conflict.value !== null) isHeld = true;
      else if (file.isInFile.value) isHeld = false;
    }),
    effect(() => {
      void [file.whole.value, file.isInFile.value, file.restored.value];
      wait(AFTER_MS);
    }),
  ];
  return () => {
    for (const stop of stops) stop();
    if (timer === undefined) return;
    window.clearTimeout(timer);
    if (!mayNot()) void Promise.resolve(file.isSound()).then((isSound) => (isSound ? save() : undefined));
  };
}
