// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Completion, CompletionContext, CompletionResult } from "@codemirror/autocomplete";
import { Decoration, type DecorationSet, type EditorView, ViewPlugin, type ViewUpdate } from "@codemirror/view";
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
const RATE_WORDS = [...RATES, "ms", "s", "min"];

const RESERVED = [...KEYWORDS, ...LOGIC].join("|");
/** A keyword, also where the next keyword or a topic follows without a blank. */
const KEYWORD = `(?<keyword>(?:${RESERVED})(?=(?:${RESERVED})*(?:/|(?![\\p{L}\\p{N}_.~[\\]-]))))`;
const BEFORE_WORDS = [
  "(?<comment>//.*)",
  '(?<string>"[^"\\n]*"?)',
  "(?<topic>/[\\w/{}~]+)",
  "(?<number>[+-]?(?:\\d+\\.?\\d*|\\.\\d+)(?:[eE][+-]?\\d+)?)",
];
const OTHERS = ["(?<word>[\\p{L}_][\\p{L}\\p{N}_.[\\]]*)", "\\S"];
const PROPERTY = [...BEFORE_WORDS, ...OTHERS].join("|");
const ANYTHING = [...BEFORE_WORDS, KEYWORD, ...OTHERS].join("|");

type Colour = "comment" | "keyword" | "logic" | "topic" | "rate" | "string";

/** What is coloured in a text, from its beginning; what words mean is the server's to say. */
export function* colouredIn(text: string): Iterable<{ from: number; to: number; colour: Colour }> {
  const [anything, property] = [new RegExp(ANYTHING, "gu"), new RegExp(PROPERTY, "gu")];
  /** How much of a check is read: a property may be called as a keyword. */
  let place: "topic" | "property" | null = null;
  for (let to = 0; ; ) {
    const pattern: RegExp = place === "property" ? property : anything;
    pattern.lastIndex = to;
    const match: RegExpExecArray | null = pattern.exec(text);
    if (match === null) return;
    to = pattern.lastIndex;
    const colour = colourOf(match.groups ?? {}, place === null);
    if (colour !== null) yield { from: match.index, to, colour };
    if (colour === "comment") continue;
    const isName = match.groups?.topic !== undefined || match.groups?.word !== undefined;
    if (match[0] === "CheckValue") place = "topic";
    else place = place === "topic" && isName ? "property" : null;
  }
}

function colourOf(
  { comment, string, topic, number, keyword, word }: Partial<Record<string, string>>,
  mayBeRate: boolean,
): Colour | null {
  if (comment !== undefined) return "comment";
  if (string !== undefined) return "string";
  if (topic !== undefined) return "topic";
  if (keyword !== undefined) return LOGIC.includes(keyword) ? "logic" : "keyword";
  const isRate = word !== undefined && mayBeRate && RATE_WORDS.includes(word);
  return number !== undefined || isRate ? "rate" : null;
}

/** Colours of the words in view. A tree of the whole text would be made anew at each key. */
export const adirfColours = ViewPlugin.define(
  (view) => ({
    marks: marksIn(view),
    update({ docChanged, viewportChanged, view }: ViewUpdate) {
      if (docChanged || viewportChanged) this.marks = marksIn(view);
    },
  }),
  { decorations: ({ marks }) => marks },
);

function marksIn({ state: { doc }, visibleRanges }: EditorView): DecorationSet {
  const marks = visibleRanges.flatMap((range) => {
    // A check may begin on the line above.
    const start = doc.lineAt(Math.max(0, doc.lineAt(range.from).from - 1)).from;
    const coloured = [...colouredIn(doc.sliceString(start, range.to))];
    return coloured.map(({ from, to, colour }) => MARKS[colour].range(start + from, start + to));
  });
  return Decoration.set(marks, true);
}

const mark = (colour: Colour) => Decoration.mark({ class: `word-${colour}` });
const MARKS: Readonly<Record<Colour, Decoration>> = {
  comment: mark("comment"),
  keyword: mark("keyword"),
  logic: mark("logic"),
  topic: mark("topic"),
  rate: mark("rate"),
  string: mark("string"),
};

/** Topics after a blank and `/`, properties after a topic of a check or bound, else keywords and levels. */
export function suggest(context: CompletionContext, vocabulary: Vocabulary | null): CompletionResult | null {
  const word = context.matchBefore(/[\w/.]*/);
  if (!word || (word.text === "" && !context.explicit) || /^\d/.test(word.text)) return null;
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
