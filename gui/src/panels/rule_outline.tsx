// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useComputed, useSignal, useSignalEffect } from "@preact/signals";
import { useRef } from "preact/hooks";
import type { Statement } from "../api/types";
import { ruleName, ruleSets } from "../blocks/rule_words";
import { statementTitle } from "../sharing/statement_title";
import type { RobotRules } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { Icon } from "../ui/icon";

/** A text with more statements than this has an outline. */
const MANY = 20;
const MOST_LETTERS = 60;
/** So many lines are drawn together once they come near the view: the browser looks after each such stretch at each frame. */
const STRETCH_LINES = 25;
const STEPS: Readonly<Record<string, number>> = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10 };

interface Props {
  editor: RuleEditor;
  robotRules: RobotRules;
  onGo(index: number): void;
  onFoldAll(isFolded: boolean): void;
}

export function isLong(editor: RuleEditor): boolean {
  return editor.shownStatements.value.length > MANY;
}

/** All statements of a long text in its sections, a line each, and the way to their blocks. */
export function RuleOutline({ editor, robotRules, onGo, onFoldAll }: Props) {
  const list = useRef<HTMLDivElement>(null);
  const active = useSignal(0);
  const sections = useComputed(() => inSections(editor.shownStatements.value, editor.shownSections.value));
  useSignalEffect(() => {
    const { spot } = editor;
    const id = spot.value && editor.statementAt(spot.value.offset)?.id;
    const index = id ? editor.shownStatements.peek().findIndex((each) => each.id === id) : -1;
    if (index >= 0) active.value = index;
  });
  useSignalEffect(() => {
    list.current?.querySelector(`#outline-${active.value}`)?.scrollIntoView({ block: "nearest" });
  });
  const press = (event: KeyboardEvent) => {
    const last = editor.shownStatements.value.length - 1;
    const step = STEPS[event.key];
    if (event.key === "Enter" || event.key === " ") onGo(active.value);
    else if (event.key === "Home") active.value = 0;
    else if (event.key === "End") active.value = last;
    else if (step !== undefined) active.value = Math.min(Math.max(active.value + step, 0), last);
    else return;
    event.preventDefault();
  };
  const states = robotRules.states.value;
  const marked = new Set(editor.findings.value.map(({ statement }) => statement));
  return (
    <nav class="outline" aria-label="Outline of the rules">
      <div class="row">
        <button type="button" class="small" onClick={() => onFoldAll(true)}>
          Fold all
        </button>
        <button type="button" class="small" onClick={() => onFoldAll(false)}>
          Unfold all
        </button>
      </div>
      <div
        ref={list}
        role="listbox"
        aria-label="Rules in the order of the text"
        tabIndex={0}
        aria-activedescendant={`outline-${active.value}`}
        onKeyDown={press}
      >
        {sections.value.map(({ title, first, statements }) => (
          <div key={first} role="group" aria-label={title || "Rules"}>
            {title && (
              <p class="section" aria-hidden="true">
                {title}
              </p>
            )}
            {inStretches(statements).map(({ from, lines }) => (
              <div key={from} class="stretch" role="presentation" style={{ "--lines": lines.length }}>
                {lines.map((statement, line) => (
                  // The keyboard chooses in the list as a whole.
                  // biome-ignore lint/a11y/useKeyWithClickEvents: see above
                  // biome-ignore lint/a11y/useFocusableInteractive: see above
                  <div
                    key={statement.key}
                    id={`outline-${first + from + line}`}
                    role="option"
                    aria-selected={first + from + line === active.value}
                    onClick={() => {
                      active.value = first + from + line;
                      onGo(first + from + line);
                    }}
                  >
                    <Line statement={statement} />
                    <span class="quiet">
                      {marked.has(statement.id ?? null) && <Icon name="warning" />}
                      {stateWords(statement, states.get(statement.id ?? "")?.state)}
                    </span>
                  </div>
                ))}
              </div>
            ))}
          </div>
        ))}
      </div>
    </nav>
  );
}

function Line({ statement }: { statement: Statement }) {
  if (statement.kind !== "rule") return <span>{statementTitle(statement)}</span>;
  return (
    <span>
      {ruleName(statement)}
      <span class="quiet sets">{ruleSets(statement, MOST_LETTERS)}</span>
    </span>
  );
}

function stateWords(statement: Statement, state: string | undefined): string {
  if (statement.kind === "rule" && statement.is_disabled) return "⊘ off";
  return state === "true" ? "✓ holds" : "";
}

interface Section {
  title: string;
  /** The number of its first statement. */
  first: number;
  statements: Statement[];
}

function inStretches(statements: readonly Statement[]): { from: number; lines: Statement[] }[] {
  return Array.from({ length: Math.ceil(statements.length / STRETCH_LINES) }, (_, number) => {
    const from = number * STRETCH_LINES;
    return { from, lines: statements.slice(from, from + STRETCH_LINES) };
  });
}

function inSections(all: readonly Statement[], titles: ReadonlyMap<number, string>): Section[] {
  const starts = [...new Set([0, ...titles.keys()])];
  return starts
    .map((first, at) => ({ title: titles.get(first) ?? "", first, statements: all.slice(first, starts[at + 1]) }))
    .filter(({ statements }) => statements.length > 0);
}
