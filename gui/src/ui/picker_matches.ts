// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** Something to pick: the word that is kept, what stands beside it, and what explains it. */
export interface PickerChoice {
  word: string;
  aside?: string;
  note?: string;
}

/** A choice that a typed text could mean; `isByName` where the text is in its word and not only in its note. */
export interface Found {
  choice: PickerChoice;
  isByName: boolean;
}

const BY_NOTE = 4;

/** The choices that a text could mean, the likeliest first; all in their order where nothing is typed. */
export function matching(choices: readonly PickerChoice[], text: string): Found[] {
  const wanted = text.toLowerCase();
  return choices
    .map((choice) => ({ choice, rank: rankOf(choice, wanted) }))
    .filter(({ rank }) => rank <= BY_NOTE)
    .sort((a, b) => a.rank - b.rank)
    .map(({ choice, rank }) => ({ choice, isByName: rank < BY_NOTE }));
}

/** 0 for the word itself, then its beginning or end, a part's beginning, within the word, within the note. */
function rankOf({ word, note }: PickerChoice, wanted: string): number {
  const name = word.toLowerCase();
  if (wanted === "") return 1;
  const bare = wanted.replace(/^\//, "");
  if (name === wanted || name === `/${bare}`) return 0;
  if (name.startsWith(wanted) || name.startsWith(`/${bare}`) || name.endsWith(`/${bare}`)) return 1;
  if (parts(name).some((part) => part.startsWith(bare)) || name.endsWith(`_${bare}`)) return 2;
  if (name.includes(wanted)) return 3;
  return note?.toLowerCase().includes(wanted) ? BY_NOTE : BY_NOTE + 1;
}

function parts(name: string): string[] {
  return name.split(/[/_.[\]]+/);
}
