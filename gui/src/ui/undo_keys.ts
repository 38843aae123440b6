// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useWindowEvent } from "./watch";

/** What can be saved, and changed back and forth. */
interface Undoable {
  undo(): void;
  redo(): void;
  save(): Promise<void>;
}

/** The key of a shortcut; a letter of a layout without Latin ones, such as ы, is the one that Latin layouts have there. */
export function shortcutKey({ key, code }: Pick<KeyboardEvent, "key" | "code">): string {
  const isOther = /^\p{L}$/u.test(key) && !/^\p{Script=Latin}$/u.test(key);
  return (isOther ? code.replace(/^Key/, "") : key).toLowerCase();
}

/** Save works everywhere on the page but in a dialog; undo and redo not in a field, where they are about its letters. */
export function useUndoKeys(editor: Undoable): void {
  const act = (event: KeyboardEvent) => {
    const isTyping = event.target instanceof HTMLInputElement && event.target.type !== "range";
    const isInDialog = event.target instanceof Element && event.target.closest("dialog") !== null;
    if (!(event.ctrlKey || event.metaKey) || isInDialog) return;
    const key = shortcutKey(event);
    if (key === "s") void editor.save();
    else if (isTyping) return;
    else if (key === "y" || (key === "z" && event.shiftKey)) editor.redo();
    else if (key === "z") editor.undo();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  useWindowEvent("keydown", act, { capture: true });
}
