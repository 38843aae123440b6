// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** What a block says in the place of topics where a recording names none. */
export const ALL_TOPICS = "all topics of the rules";

/** The topics that somebody typed, with blanks or commas between; none stand for all. */
export function parseTopics(text: string): string[] {
  return text.trim() === ALL_TOPICS ? [] : text.split(/[\s,]+/).filter((word) => word !== "");
}

export function topicsText(topics: readonly string[]): string {
  return topics.length === 0 ? ALL_TOPICS : topics.join(" ");
}
