// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Bound, type Rate, TIERS, type Tier } from "../api/types";
import { numberProblemOr, typedNumber } from "../ui/numbers";

export const RATE_WORDS: readonly string[] = [...TIERS, "Full", "Off"];

/** A rate as a block shows it; `Hz` is said by the block. */
export function rateText(rate: Rate): string {
  switch (rate.kind) {
    case "hz":
      return String(rate.value);
    case "tier":
      return rate.value;
    case "full":
      return "Full";
    case "off":
      return "Off";
  }
}

/** What somebody typed as a rate, in any case of letters and with or without Hz; null where it is none. */
export function parseRate(text: string): Rate | null {
  const words = withoutHz(text);
  const word = RATE_WORDS.find((each) => each.toLowerCase() === words.toLowerCase());
  if (word === "Full") return { kind: "full", value: null };
  if (word === "Off") return { kind: "off", value: null };
  if (word !== undefined) return { kind: "tier", value: word as Tier };
  const hz = typedNumber(words);
  return Number.isFinite(hz) && hz >= 0 ? { kind: "hz", value: hz } : null;
}

/** Why a text is no rate, in words; empty where it is one. */
export function rateProblem(text: string): string {
  if (parseRate(text) !== null) return "";
  return numberProblemOr(withoutHz(text), "A rate is a number of Hz, Full, Off or a quality level");
}

function withoutHz(text: string): string {
  return text.trim().replace(/\s*hz$/i, "");
}

/** What somebody typed as a bound: a number or a level's name in any case of letters; null where it is none. */
export function parseBound(text: string): Bound | null {
  const word = text.trim();
  const tier = TIERS.find((each) => each.toLowerCase() === word.toLowerCase());
  if (tier !== undefined) return tier;
  const bound = typedNumber(word);
  return Number.isFinite(bound) && bound >= 0 ? bound : null;
}

/** Why a text is no bound, in words; empty where it is one. */
export function boundProblem(text: string): string {
  if (parseBound(text) !== null) return "";
  return numberProblemOr(text, "A bound is a number or a quality level");
}

/** What a block says in the place of topics where a recording names none. */
export const ALL_TOPICS = "all topics of the rules";

/** The topics that somebody typed, with blanks or commas between; none stand for all. */
export function parseTopics(text: string): string[] {
  return text.trim() === ALL_TOPICS ? [] : text.split(/[\s,]+/).filter((word) => word !== "");
}

export function topicsText(topics: readonly string[]): string {
  return topics.length === 0 ? ALL_TOPICS : topics.join(" ");
}
