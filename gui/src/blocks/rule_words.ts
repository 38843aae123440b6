// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import {
  type Action,
  type Bound,
  type Rate,
  type RuleStatement,
  type SetStatement,
  type Statement,
  TIERS,
  type Tier,
} from "../api/types";
import { checksOf } from "../state/statements";
import { numberProblemOr, typedNumber } from "../ui/numbers";

/** What an action does, in the fewest words. */
export function actionWords(action: Action): string {
  switch (action.kind) {
    case "set":
      return `${action.topic} ${rateWords(action)}`;
    case "within":
      return `${action.topic} ${action.property} ${action.bound}`;
    case "record":
      return `record ${[action.name, ...action.topics].join(" ")}`;
    case "parameter":
      return `${action.node} ${action.parameter} ${action.value}`;
    case "call":
      return `call ${action.service}${action.argument == null ? "" : ` ${action.argument}`}`;
    case "notify":
      return `notify “${action.text}”`;
  }
}

/** The rate that a statement sets, with its unit, and what a margin goes by. */
function rateWords({ rate, margin }: SetStatement): string {
  const words = (one: Rate) => `${rateText(one)}${one.kind === "hz" ? " Hz" : ""}`;
  return margin ? `${words(rate)} … ${words(margin.to)} by ${margin.topic} ${margin.property}` : words(rate);
}

/** What can be added beside other statements. */
export type NewStatement = "rule" | "rate" | "floor" | "bound";
export const NEW_STATEMENTS: Readonly<Record<NewStatement, string>> = {
  rate: "New rate",
  rule: "New rule",
  floor: "New floor",
  bound: "New bound",
};

/** What a rule is called, or when it holds. */
export function ruleName({ name, condition }: RuleStatement): string {
  if (name) return name;
  const [first, ...others] = checksOf(condition);
  const words = first ? `if ${first.topic} ${first.property} ${first.op} ${first.value}` : "if";
  return others.length > 0 ? `${words} …` : words;
}

/** What a rule sets, in at most about so many letters. */
export function ruleSets({ then, else: otherwise }: RuleStatement, mostLetters: number): string {
  const all = [...then.map(actionWords), ...otherwise.map((action) => `else ${actionWords(action)}`)];
  let count = 1;
  while (count < all.length && all.slice(0, count + 1).join(", ").length <= mostLetters) count++;
  const more = all.length - count;
  const shown = all.slice(0, count).join(", ");
  const cut = shown.length > mostLetters ? `${shown.slice(0, mostLetters - 1)}…` : shown;
  return more > 0 ? `${cut} and ${more} more` : cut;
}

/** A statement in a few words, for lists. */
export function statementTitle(statement: Statement): string {
  switch (statement.kind) {
    case "set":
      return `${statement.topic} at ${rateWords(statement)}`;
    case "keep":
      return `keep ${statement.topic} at least at ${statement.hz} Hz`;
    case "within":
      return `keep ${statement.topic} ${statement.property} within ${statement.bound}`;
    case "rule":
      return `Rule ${ruleName(statement)}`;
    case "raw":
      return statement.text.split(/\r?\n/, 1)[0] ?? "";
  }
}

/** Words of the checker for people who see blocks: rules by their names, and no lines. */
export function withoutLines(words: string, statements: readonly Statement[]): string {
  const nameAt = (line: string) => {
    const rule = statements.find((each) => each.kind === "rule" && each.line === Number(line));
    return rule?.kind === "rule" ? ruleName(rule) : null;
  };
  return words
    .replace(/"?\b(?:the )?(?:block|rule) at line (\d+)"?( \(line \1\))?/g, (all, line) => {
      const name = nameAt(line);
      return name === null ? all : `“${name}”`;
    })
    .replace(/ \(line \d+\)/g, "");
}

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
