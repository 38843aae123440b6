// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Completion, CompletionContext, CompletionResult } from "@codemirror/autocomplete";
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from "@codemirror/language";
import { tags } from "@lezer/highlight";
import { TIERS, type Vocabulary } from "../api/types";
import { ON_ROBOT } from "../blocks/suggestions";

const KEYWORDS = [
  "begin",
  "end",
  "SetFrequency",
  "KeepAtLeast",
  "KeepWithin",
  "Record",
  "Before",
  "After",
  "Disabled",
  "Rule",
  "Priority",
  "If",
  "Then",
  "Else",
  "EndIf",
];
const LOGIC = ["AND", "OR", "Not", "CheckValue", "For", "Within", "Until"];
const RATES = [...TIERS, "Full", "Off", "Hz"];
const UNITS_OF_TIME = ["ms", "s", "min"];

const RESERVED = [...KEYWORDS, ...LOGIC].join("|");
/** A keyword, also where the next keyword or a topic follows without a blank. */
const KEYWORD = new RegExp(`^(?:${RESERVED})(?=(?:${RESERVED})*(?:/|(?![\\p{L}\\p{N}_.~[\\]-])))`, "u");
const WORD = /^[\p{L}_][\p{L}\p{N}_.[\]]*/u;

/** Colours of the words; what they mean is the server's to say. `place` is how much of a check is read. */
export const adirf = StreamLanguage.define<{ place: "topic" | "property" | null }>({
  startState: () => ({ place: null }),
  token(stream, state) {
    if (stream.eatSpace()) return null;
    if (stream.match(/\/\/.*/)) return "comment";
    const { place } = state;
    state.place = null;
    if (stream.match(/"[^"]*"?/)) return "string";
    if (stream.match(/\/[\w/{}~]+/)) {
      if (place === "topic") state.place = "property";
      return "variableName";
    }
    if (stream.match(/[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?/)) return "number";
    if (stream.match(/[<>=!]+/)) return "operator";
    if (place !== "property") {
      const keyword = (stream.match(KEYWORD) as RegExpMatchArray | null)?.[0];
      if (keyword === "CheckValue") state.place = "topic";
      if (keyword !== undefined) return LOGIC.includes(keyword) ? "logic" : "keyword";
    }
    const word = stream.match(WORD) as RegExpMatchArray | null;
    if (word === null) stream.next();
    else if (place === "topic") state.place = "property";
    return place === null && [...RATES, ...UNITS_OF_TIME].includes(word?.[0] ?? "") ? "atom" : null;
  },
  tokenTable: { logic: tags.logicOperator },
  languageData: { commentTokens: { line: "//" } },
});

export const adirfColours = syntaxHighlighting(
  HighlightStyle.define([
    { tag: tags.comment, color: "var(--text-2)", fontStyle: "italic" },
    { tag: tags.keyword, color: "var(--code-keyword)", fontWeight: "600" },
    { tag: tags.logicOperator, color: "var(--code-check)", fontWeight: "600" },
    { tag: tags.variableName, color: "var(--code-topic)" },
    { tag: [tags.number, tags.atom], color: "var(--code-rate)" },
    { tag: tags.string, color: "var(--code-string)" },
  ]),
);

/** Topics after a blank and `/`, properties after a topic of a check or bound, else keywords and levels. */
export function suggest(context: CompletionContext, vocabulary: Vocabulary | null): CompletionResult | null {
  const word = context.matchBefore(/[\w/.]*/);
  if (!word || (word.text === "" && !context.explicit)) return null;
  const line = context.state.doc.lineAt(context.pos);
  const before = line.text.slice(0, word.from - line.from);
  if (isInComment(before + word.text)) return null;
  return { from: word.from, options: options(before, word.text, vocabulary), validFor: /^[\w/.]*$/ };
}

/** Whether a comment begins in `text`, which is the beginning of a line. */
function isInComment(text: string): boolean {
  return text.replace(/"[^"]*"/g, "").includes("//");
}

function options(before: string, word: string, vocabulary: Vocabulary | null): Completion[] {
  const [, keyword, named] = /(CheckValue|KeepWithin)\s*(\S+)\s+$/.exec(before) ?? [];
  const topics = vocabulary?.topics ?? [];
  if (named !== undefined) {
    const { properties = [], bounds = [] } = topics.find(({ topic }) => topic === named) ?? {};
    const more = vocabulary?.every_topic ?? [];
    return (keyword === "CheckValue" ? [...properties, ...more] : [...bounds, ...properties]).map(
      ({ name, unit, meaning }) => ({ label: name, detail: unit, info: meaning, type: "property" }),
    );
  }
  if (word.startsWith("/") || /(SetFrequency|KeepAtLeast|KeepWithin|CheckValue|Record\s+"[^"]*")\s*$/.test(before)) {
    return topics.map(({ topic, type, source }) => ({
      label: topic,
      detail: [type, source === "robot" ? ON_ROBOT : null].filter(Boolean).join(", "),
      type: "variable",
    }));
  }
  return [...KEYWORDS, ...LOGIC, ...RATES].map((label) => ({ label, type: "keyword" }));
}
