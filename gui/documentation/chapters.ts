// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** A document of the project that the page shows. */
export interface Chapter {
  /** Where its Markdown lies, in the project. */
  file: string;
  /** What links of the page to its beginning name. */
  anchor: string;
  title: string;
}

export const CHAPTERS: readonly Chapter[] = [
  { file: "docs/language.md", anchor: "language", title: "The language" },
  { file: "docs/reference/checks.md", anchor: "findings", title: "Findings, and why" },
  { file: "docs/reference/checks-rates.md", anchor: "findings-rates", title: "Findings: rates and blocks" },
  { file: "docs/reference/checks-conditions.md", anchor: "findings-conditions", title: "Findings: conditions" },
  { file: "docs/reference/checks-topics.md", anchor: "findings-topics", title: "Findings: topics and properties" },
  { file: "docs/reference/checks-bounds.md", anchor: "findings-bounds", title: "Findings: bounds and recordings" },
  { file: "docs/reference/properties.md", anchor: "properties", title: "Properties and units" },
  { file: "docs/quality-levels.md", anchor: "levels", title: "Quality levels" },
];

/**
 * The anchor on the page to which a link in `file` leads; null where that is not on the page.
 *
 * Headings keep the anchors that GitHub gives them; the page has each of them once.
 */
export function anchorOf(link: string, file: string): string | null {
  if (/^[a-z]+:/i.test(link)) return null;
  const { pathname, hash } = new URL(link, `file:///${file}`);
  const target = CHAPTERS.find((chapter) => `/${chapter.file}` === pathname);
  return target ? decodeURIComponent(hash.slice(1)) || target.anchor : null;
}
