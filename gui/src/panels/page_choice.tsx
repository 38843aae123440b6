// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { PAGE, type Pages } from "../blocks/pages";

/** Which of many statements are shown as blocks, and the way to the others. */
export function PageChoice({ pages, onGo }: { pages: Pages; onGo: (index: number) => void }) {
  const { first, count, total } = pages;
  if (count >= total) return null;
  return (
    <div class="page-choice" role="group" aria-label="Part of the rules">
      <button type="button" class="small" disabled={first === 0} onClick={() => onGo(Math.max(0, first - PAGE))}>
        Earlier
      </button>
      <span>
        {first + 1}–{first + count} of {total}
      </span>
      <button type="button" class="small" disabled={first + count >= total} onClick={() => onGo(first + count)}>
        Later
      </button>
    </div>
  );
}
