// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { autocompletion, completionKeymap, completionStatus, startCompletion } from "@codemirror/autocomplete";
import { defaultKeymap } from "@codemirror/commands";
import { indentUnit } from "@codemirror/language";
import { type Diagnostic, forEachDiagnostic, lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { EditorSelection, EditorState, StateEffect, StateField } from "@codemirror/state";
import { Decoration, type DecorationSet, EditorView, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import type { PlacedFinding, Vocabulary } from "../api/types";
import { difference } from "./difference";
import { adirfColours, suggest } from "./language";

/** The list turns pages and does not scroll: the keyboard cannot reach a part that does. */
const SUGGESTIONS_SHOWN = 10;

/** After this pause a list opens: who goes on typing knows the word, and a list takes long to draw. */
const SUGGESTED_AFTER_MS = 200;

/** What the text tells and asks. */
interface TextOwner {
  typed(text: string): void;
  cursorAt(offset: number): void;
  fix(finding: PlacedFinding): void;
  vocabulary(): Vocabulary | null;
}

const setSpot = StateEffect.define<{ from: number; to: number } | null>();
const spotMark = Decoration.mark({ class: "spot" });
const spotField = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(marks, transaction) {
    let next = marks.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(setSpot)) continue;
      const spot = effect.value;
      next = spot && spot.to > spot.from ? Decoration.set([spotMark.range(spot.from, spot.to)]) : Decoration.none;
    }
    return next;
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** The text of a rule file, with marks where the checker found something. */
export class TextEditor {
  private readonly view: EditorView;
  /** Whether a change comes from the page and not from a key. */
  private isOurs = false;
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
          // The first is the inner one: a spot is one piece.
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
          EditorView.updateListener.of((update) => {
            if (this.isOurs) return;
            if (update.docChanged) {
              this.text = update.state.doc.toString();
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

  private quietly(work: () => void): void {
    this.isOurs = true;
    try {
      work();
    } finally {
      this.isOurs = false;
    }
  }
}

/** All that a mark shows, at a place. */
function saidBy(
  { severity, source, message, actions }: Omit<Diagnostic, "from" | "to">,
  from: number,
  to: number,
): string {
  return JSON.stringify([from, to, severity, source, message, actions?.map(({ name }) => name)]);
}
