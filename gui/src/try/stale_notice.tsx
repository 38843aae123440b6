// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** That a try is of something else than what there is now; nothing where all is the same. */
export function StaleNotice({ changed, advice }: { changed: readonly string[]; advice: string }) {
  if (changed.length === 0) return null;
  return (
    <p class="notice warning" role="status">
      Stale: {andWords(changed)} changed since. {advice}
    </p>
  );
}

/** `rules and recording`. */
function andWords(words: readonly string[]): string {
  return [words.slice(0, -1).join(", "), ...words.slice(-1)].filter(Boolean).join(" and ");
}
