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
