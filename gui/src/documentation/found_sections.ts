// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** What stands below one heading. */
export interface Section {
  title: string;
  /** The heading of the chapter that it is in; its own for a chapter. */
  chapter: string;
  text: string;
}

export interface FoundSection<S extends Section> {
  section: S;
  /** The words around the first one that was found. */
  excerpt: string;
}

const BEFORE = 30;
const EXCERPT = 110;

/** The sections that hold all words of a query, those with more of them in their heading first. */
export function foundSections<S extends Section>(sections: readonly S[], query: string): FoundSection<S>[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  const [first] = words;
  if (first === undefined) return [];
  return sections
    .map((section) => ({ section, inTitle: words.filter((word) => section.title.toLowerCase().includes(word)).length }))
    .filter(({ section }) => {
      const all = `${section.title} ${section.text}`.toLowerCase();
      return words.every((word) => all.includes(word));
    })
    .sort((one, other) => other.inTitle - one.inTitle)
    .map(({ section }) => ({ section, excerpt: excerptOf(section.text, first) }));
}

function excerptOf(text: string, word: string): string {
  const at = Math.max(0, text.toLowerCase().indexOf(word));
  const start = at <= BEFORE ? 0 : text.indexOf(" ", at - BEFORE) + 1;
  const end = text.length <= start + EXCERPT ? text.length : text.lastIndexOf(" ", start + EXCERPT);
  return `${start > 0 ? "… " : ""}${text.slice(start, Math.max(end, at + word.length))}${end < text.length ? " …" : ""}`;
}
