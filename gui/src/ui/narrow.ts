// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
/** Of a page that shows one thing below the other. */
export const NARROW = "(max-width: 900px)";

/** Scrolls to what is below everything else on a narrow screen; on a wide one everything is there. */
export function showOnNarrow(shown: () => Element | null): void {
  if (matchMedia(NARROW).matches) requestAnimationFrame(() => shown()?.scrollIntoView());
}
