// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useLayoutEffect, useRef } from "preact/hooks";

/** Calls `resized` when `host` has another size; returns how to stop. */
export function watchSize(host: HTMLElement, resized: () => void): () => void {
  const observer = new ResizeObserver(resized);
  observer.observe(host);
  return () => observer.disconnect();
}

/** Calls `changed` when the page turns light or dark; returns how to stop. */
export function watchTheme(changed: () => void): () => void {
  const query = matchMedia("(prefers-color-scheme: dark)");
  query.addEventListener("change", changed);
  return () => query.removeEventListener("change", changed);
}

/** Whether somebody points with a finger; blocks are also made where there is no screen. */
export function isForFingers(): boolean {
  return "matchMedia" in globalThis && matchMedia("(pointer: coarse)").matches;
}

/** Of a page that shows one thing below the other. */
const NARROW = "(max-width: 900px)";

/** Whether it is one now. */
export function isNarrow(): boolean {
  return matchMedia(NARROW).matches;
}

/** Calls `changed` when the page gets narrow or wide, as a tablet that is turned; returns how to stop. */
export function watchNarrow(changed: () => void): () => void {
  const query = matchMedia(NARROW);
  query.addEventListener("change", changed);
  return () => query.removeEventListener("change", changed);
}

/** Scrolls to what is below everything else on a narrow screen; on a wide one everything is there. */
export function showOnNarrow(shown: () => Element | null): void {
  if (isNarrow()) requestAnimationFrame(() => shown()?.scrollIntoView());
}

/** Gives the focus to what `selector` finds first in `host`, where it was on something that is gone. */
export function focusIn(host: Element | null, selector: string): void {
  if (document.activeElement === document.body) host?.querySelector<HTMLElement>(selector)?.focus();
}

/** Does on an event of the window what `act` is then; at once, so that no event falls between. */
export function useWindowEvent<Type extends keyof WindowEventMap>(
  type: Type,
  act: (event: WindowEventMap[Type]) => void,
  options: { capture?: true } = {},
): void {
  const acting = useRef(act);
  acting.current = act;
  useLayoutEffect(() => {
    const happened = (event: WindowEventMap[Type]) => acting.current(event);
    addEventListener(type, happened, options);
    return () => removeEventListener(type, happened, options);
  }, []);
}

/** What a variable of the style sheet is where `host` stands. */
export function styleOf(host: Element): (name: string) => string {
  const style = getComputedStyle(host);
  return (name) => style.getPropertyValue(name).trim();
}

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
