// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal, useComputed, useSignal, useSignalEffect } from "@preact/signals";
import type { ComponentChildren, VNode } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Statement } from "../api/types";
import type { RuleState } from "../blocks/live_states";
import { ruleName, ruleSets, statementTitle } from "../blocks/rule_words";
import type { RobotRules } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { Button, Icon } from "../ui/button";

/** A text with more statements than this has an outline. */
const MANY = 20;
const MOST_LETTERS = 60;
const MARK = "!";
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
  const drawn = useRef(new Map<number, { said: string; node: VNode }>());
  const go = useRef(onGo);
  go.current = onGo;
  const sections = useComputed(() => inSections(editor.shownStatements.value, editor.shownSections.value));
  // At once: waiting for the next picture would draw one more for each key.
  useEffect(
    () =>
      effect(() => {
        const { spot } = editor;
        const id = spot.value && editor.statementAt(spot.value.offset)?.id;
        const index = id ? editor.shownStatements.peek().findIndex((each) => each.id === id) : -1;
        if (index >= 0) active.value = index;
      }),
    [],
  );
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
  const doubts = editor.findings.value.filter(({ severity }) => severity !== "info");
  const marked = new Set(doubts.map(({ statement }) => statement));
  return (
    <nav class="outline" aria-label="Outline of the rules">
      <div class="row">
        <Button label="Fold all" class="small" onClick={() => onFoldAll(true)} />
        <Button label="Unfold all" class="small" onClick={() => onFoldAll(false)} />
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
            {inStretches(statements).map(({ from, lines }) => {
              const at = first + from;
              const notes = lines.map((statement) => noteOf(statement, marked, states));
              const isActive = active.value >= at && active.value < at + lines.length;
              const said = [
                isActive ? active.value : "",
                ...lines.map(({ key }, line) => `${key} ${notes[line]}`),
              ].join();
              const known = drawn.current.get(at);
              // The same node again is not looked at: a key changes one stretch of many.
              if (known?.said === said) return known.node;
              const node = (
                <div key={from} class="stretch" role="presentation" style={{ "--lines": lines.length }}>
                  {lines.map((statement, line) => (
                    <Line
                      key={statement.key}
                      {...{ statement, active }}
                      index={at + line}
                      note={notes[line] ?? ""}
                      onGo={go}
                    />
                  ))}
                </div>
              );
              drawn.current.set(at, { said, node });
              return node;
            })}
          </div>
        ))}
      </div>
    </nav>
  );
}

interface LineProps {
  statement: Statement;
  index: number;
  note: string;
  active: Signal<number>;
  onGo: { readonly current: (index: number) => void };
}

function Line({ statement, index, note, active, onGo }: LineProps) {
  return (
    <OptionRow
      id={`outline-${index}`}
      isChosen={index === active.peek()}
      act={() => {
        active.value = index;
        onGo.current(index);
      }}
    >
      {statement.kind === "rule" ? (
        <span>
          {ruleName(statement)}
          <span class="quiet sets">{ruleSets(statement, MOST_LETTERS)}</span>
        </span>
      ) : (
        <span>{statementTitle(statement)}</span>
      )}
      <span class="quiet">
        {note.startsWith(MARK) && <Icon name="warning" />}
        {note.replace(MARK, "")}
      </span>
    </OptionRow>
  );
}

/** What stands behind a statement: whether something was found in it, and its state. */
function noteOf(
  statement: Statement,
  marked: ReadonlySet<string | null>,
  states: ReadonlyMap<string, RuleState>,
): string {
  const id = statement.id ?? "";
  const isOff = statement.kind === "rule" && statement.is_disabled;
  const state = isOff ? "⊘ off" : states.get(id)?.state === "true" ? "✓ holds" : "";
  return `${marked.has(id) ? MARK : ""}${state}`;
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

/** A line of a list; the keyboard chooses where the list is controlled from, and not in the line. */
export function OptionRow(props: { id: string; isChosen: boolean; act: () => void; children: ComponentChildren }) {
  return (
    // biome-ignore lint/a11y/useKeyWithClickEvents: see above
    // biome-ignore lint/a11y/useFocusableInteractive: see above
    <div id={props.id} role="option" aria-selected={props.isChosen} onClick={props.act}>
      {props.children}
    </div>
  );
}
