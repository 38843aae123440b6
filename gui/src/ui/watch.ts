// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

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
