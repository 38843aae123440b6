// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import {
  autocompletion,
  type Completion,
  type CompletionContext,
  type CompletionResult,
  completionKeymap,
  completionStatus,
  startCompletion,
} from "@codemirror/autocomplete";
import { defaultKeymap } from "@codemirror/commands";
import { indentUnit } from "@codemirror/language";
import { type Diagnostic, forEachDiagnostic, lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { EditorSelection, EditorState, StateEffect, StateField, type Text } from "@codemirror/state";
import {
  Decoration,
  type DecorationSet,
  EditorView,
  highlightActiveLine,
  keymap,
  lineNumbers,
  ViewPlugin,
  type ViewUpdate,
} from "@codemirror/view";
import { type PlacedFinding, TIERS, type Vocabulary } from "../api/types";
import { ON_ROBOT } from "../blocks/suggestions";
import { difference } from "./difference";

/** The list turns pages and does not scroll: the keyboard cannot reach a part that does. */
const SUGGESTIONS_SHOWN = 10;

/** Suggestions open after this pause: an open list slows down typing. */
const SUGGESTED_AFTER_MS = 200;

/** What the text tells and asks. */
interface TextOwner {
  typed(text: string): void;
  /** Somebody wrote, and is elsewhere now. */
  left(): void;
  cursorAt(offset: number): void;
  fix(finding: PlacedFinding): void;
  vocabulary(): Vocabulary | null;
}

const setSpot = StateEffect.define<{ from: number; to: number } | null>();
const spotLine = Decoration.line({ class: "spot" });
const spotField = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(marks, transaction) {
    let next = marks.map(transaction.changes);
    for (const effect of transaction.effects) if (effect.is(setSpot)) next = linesOf(effect.value, transaction.newDoc);
    return next;
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** The whole lines of a stretch, which are marked as one piece. */
function linesOf(spot: { from: number; to: number } | null, doc: Text): DecorationSet {
  if (spot === null || spot.to <= spot.from) return Decoration.none;
  const [first, last] = [doc.lineAt(spot.from).number, doc.lineAt(spot.to).number];
  const numbers = Array.from({ length: last - first + 1 }, (_, at) => first + at);
  return Decoration.set(numbers.map((number) => spotLine.range(doc.line(number).from)));
}

/** The text of a rule file, with marks where the checker found something. */
export class TextEditor {
  private readonly view: EditorView;
  /** Whether a change comes from the page and not from a key. */
  private isOurs = false;
  private isWritten = false;
  private findings: readonly PlacedFinding[] = [];

  constructor(
    host: HTMLElement,
    private readonly owner: TextOwner,
    /** What the view shows, as one string: making it anew takes long for a long text. */
    private text: string,
  ) {
    this.view = new EditorView({
      parent: host,
      state: EditorState.create({
        doc: text,
        extensions: [
          // Split at \n alone, so that a carriage return is a letter like any other and no byte is lost.
          EditorState.lineSeparator.of("\n"),
          lineNumbers(),
          lintGutter(),
          EditorView.lineWrapping,
          highlightActiveLine(),
          adirfColours,
          spotField,
          EditorState.languageData.of(() => [{ commentTokens: { line: "//" } }]),
          indentUnit.of("    "),
          autocompletion({
            override: [(context) => suggest(context, owner.vocabulary())],
            maxRenderedOptions: SUGGESTIONS_SHOWN,
            activateOnTypingDelay: SUGGESTED_AFTER_MS,
          }),
          keymap.of([...completionKeymap, ...lintKeymap, ...defaultKeymap]),
          EditorView.contentAttributes.of({ "aria-label": "Rules as text", spellcheck: "false", tabindex: "0" }),
          EditorView.domEventHandlers({ blur: (event) => this.leave(event.relatedTarget) }),
          EditorView.updateListener.of((update) => {
            if (this.isOurs) return;
            if (update.docChanged) {
              this.text = update.state.doc.toString();
              this.isWritten = true;
              owner.typed(this.text);
            }
            if (update.selectionSet) owner.cursorAt(update.state.selection.main.head);
          }),
        ],
      }),
    });
  }

  /** Shows a text, changing only the stretch that differs, so that the cursor stays. */
  setText(text: string): void {
    if (text === this.text) return;
    const now = this.view.state.doc.toString();
    this.text = text;
    if (text === now) return;
    const { from, tail } = difference(now, text);
    this.quietly(() =>
      this.view.dispatch({ changes: { from, to: now.length - tail, insert: text.slice(from, text.length - tail) } }),
    );
  }

  /** Offers what the vocabulary has by now, where completions are offered already. */
  suggestAnew(): void {
    if (completionStatus(this.view.state) !== null) startCompletion(this.view);
  }

  /** Marks what was found; where the marks that moved with the text say the same, nothing is drawn anew. */
  mark(findings: readonly PlacedFinding[]): void {
    const { state } = this.view;
    const end = state.doc.length;
    const words = (all: readonly PlacedFinding[]) => all.map(({ code, message }) => `${code} ${message}`).join("\n");
    const isSameOrder = words(this.findings) === words(findings);
    this.findings = findings;
    const diagnostics = findings.map((finding, index): Diagnostic => {
      const { fix } = finding;
      // The finding at this place of the newest list.
      const apply = () => this.findings[index] && this.owner.fix(this.findings[index]);
      return {
        from: Math.min(finding.offset, end),
        to: Math.min(finding.end_offset, end),
        severity: finding.severity,
        source: finding.code,
        message: finding.hint ? `${finding.message}. ${finding.hint}` : finding.message,
        ...(fix ? { actions: [{ name: fix.title, apply }] } : {}),
      };
    });
    const said = diagnostics.map(({ from, to, ...of }) => saidBy(of, from, to)).sort();
    const shown: string[] = [];
    forEachDiagnostic(state, (of, from, to) => shown.push(saidBy(of, from, to)));
    if (isSameOrder && said.join("\n") === shown.sort().join("\n")) return;
    this.quietly(() => this.view.dispatch(setDiagnostics(state, diagnostics)));
  }

  /** Highlights a stretch and scrolls to it; with `focus` the cursor goes there too. An empty one is no highlight. */
  reveal(offset: number, endOffset: number, focus: boolean): void {
    const end = this.view.state.doc.length;
    const [from, to] = [Math.min(offset, end), Math.min(endOffset, end)];
    if (from === to && !focus && this.view.state.field(spotField) === Decoration.none) return;
    const effects: StateEffect<unknown>[] = [setSpot.of({ from, to })];
    if (focus || to > from) {
      effects.push(EditorView.scrollIntoView(EditorSelection.range(to, from), { y: "nearest", yMargin: 24 }));
    }
    this.quietly(() => this.view.dispatch({ effects, ...(focus ? { selection: { anchor: from } } : {}) }));
    if (focus) this.view.focus();
  }

  dispose(): void {
    this.view.destroy();
  }

  private leave(to: EventTarget | null): void {
    // A window that is left is not the text that is left; its tooltips belong to it.
    const isHere = !document.hasFocus() || (to instanceof Node && this.view.dom.contains(to));
    if (isHere || !this.isWritten) return;
    this.isWritten = false;
    this.owner.left();
  }

  private quietly(work: () => void): void {
    this.isOurs = true;
    try {
      work();
    } finally {
      this.isOurs = false;
    }
  }
}

/** What a mark shows, and its place. */
function saidBy(
  { severity, source, message, actions }: Omit<Diagnostic, "from" | "to">,
  from: number,
  to: number,
): string {
  return JSON.stringify([from, to, severity, source, message, actions?.map(({ name }) => name)]);
}

const KEYWORDS = [
  "begin",
  "end",
  "SetFrequency",
  "KeepAtLeast",
  "KeepWithin",
  "By",
  "Record",
  "Before",
  "After",
  "SetParameter",
  "Call",
  "Notify",
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
const RATE_WORDS = [...RATES, "ms", "s", "min", "true", "false"];

const RESERVED = [...KEYWORDS, ...LOGIC].join("|");
/** A keyword, also where the next keyword or a topic follows without a blank. */
const KEYWORD = `(?<keyword>(?:${RESERVED})(?=(?:${RESERVED})*(?:/|(?![\\p{L}\\p{N}_.~[\\]-]))))`;
const STRING = '"(?:[^"\\\\\\n]|\\\\.)*"';
const BEFORE_WORDS = [
  "(?<comment>//.*)",
  `(?<string>${STRING}?)`,
  "(?<topic>/[\\w/{}~*]+|@\\w+)",
  "(?<number>[+-]?(?:\\d+\\.?\\d*|\\.\\d+)(?:[eE][+-]?\\d+)?)",
];
const OTHERS = [`(?<word>[\\p{L}_](?:[\\p{L}\\p{N}_.[\\]]|(?<=\\[)(?:${STRING}|\\*|-1))*)`, "\\S"];
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
const adirfColours = ViewPlugin.define(
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
  const word = context.matchBefore(/[\w/.@]*/);
  if (!word || (word.text === "" && !context.explicit) || /^\d/.test(word.text)) return null;
  const line = context.state.doc.lineAt(context.pos);
  const before = line.text.slice(0, word.from - line.from);
  if (isInComment(before + word.text)) return null;
  return { from: word.from, options: options(before, word.text, vocabulary), validFor: /^[\w/.@]*$/ };
}

/** Whether a comment begins in `text`, which is the beginning of a line. */
function isInComment(text: string): boolean {
  return text.replace(/"[^"]*"/g, "").includes("//");
}

function options(before: string, word: string, vocabulary: Vocabulary | null): Completion[] {
  const [, of, compared] = /CheckValue\s*(\S+)\s+(\S+)\s*[<>!=]+\s*$/.exec(before) ?? [];
  if (of !== undefined) {
    const properties = vocabulary?.topics.find(({ topic }) => topic === of)?.properties ?? [];
    const words = properties.find(({ name }) => name === compared)?.words ?? [];
    return words.map((label) => ({ label, type: "constant" }));
  }
  const [, keyword, named] = /(CheckValue|KeepWithin)\s*(\S+)\s+$/.exec(before) ?? [];
  const topics = vocabulary?.topics ?? [];
  const vitals = vocabulary?.vitals ?? [];
  if (named !== undefined) {
    const own = vitals.find(({ name }) => name === named);
    const { properties = [], bounds = [] } = topics.find(({ topic }) => topic === named) ?? {};
    const more = vocabulary?.every_topic ?? [];
    const checked = own?.properties ?? [...properties, ...more];
    return (keyword === "CheckValue" ? checked : [...bounds, ...properties]).map(({ name, unit, meaning }) => ({
      label: name,
      detail: unit,
      info: meaning,
      type: "property",
    }));
  }
  const isChecked = /CheckValue\s*$/.test(before);
  const others = isChecked
    ? vitals.map(({ name, meaning }) => ({ label: name, detail: meaning, type: "variable" }))
    : [];
  if (word.startsWith("@")) return others;
  if (word.startsWith("/") || /(SetFrequency|KeepAtLeast|KeepWithin|CheckValue|Record\s+"[^"]*")\s*$/.test(before)) {
    const named = topics.map(({ topic, type, source }) => ({
      label: topic,
      detail: [type, source === "robot" ? ON_ROBOT : null].filter(Boolean).join(", "),
      type: "variable",
    }));
    return [...named, ...others];
  }
  return [...KEYWORDS, ...LOGIC, ...RATES].map((label) => ({ label, type: "keyword" }));
}
