// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useComputed, useSignal } from "@preact/signals";
import { useRef } from "preact/hooks";
import type { PlacedFinding, Statement } from "../api/types";
import type { RuleState } from "../blocks/live_states";
import { actionWords, NEW_STATEMENTS, type NewStatement, statementTitle } from "../blocks/rule_words";
import type { RobotRules } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { checksOf } from "../state/statements";
import { Button, Icon } from "../ui/button";
import { shortcutKey, useWindowEvent } from "../ui/watch";
import { OptionRow } from "./rule_outline";

const SHOWN = 50;
const LIMITS: [Limit, string][] = [
  ["all", "All"],
  ["off", "Switched off"],
  ["findings", "With findings"],
  ["holds", "Holds now"],
];

interface Props {
  editor: RuleEditor;
  robotRules: RobotRules;
  onGo(index: number): void;
  /** Null where nothing can be added. */
  onAdd: ((kind: NewStatement) => void) | null;
}

/** Finds rules by what stands in them, on whichever page of the blocks they are. */
export function RuleSearch({ editor, robotRules, onGo, onAdd }: Props) {
  const field = useRef<HTMLInputElement>(null);
  const query = useSignal("");
  const limit = useSignal<Limit>("all");
  const isOpen = useSignal(false);
  const chosen = useSignal(0);
  const hits = useComputed(() =>
    isOpen.value
      ? found(editor.shownStatements.value, query.value, limit.value, {
          findings: editor.findings.value,
          states: robotRules.states.value,
        })
      : [],
  );
  const additions = onAdd === null ? [] : additionsOf(query.value);
  useSearchKeys(field);
  const change = (work: () => void) => {
    work();
    isOpen.value = true;
    chosen.value = 0;
  };
  const go = (hit: Found | undefined) => {
    if (hit === undefined) return;
    isOpen.value = false;
    onGo(hit.index);
  };
  const add = (kind: NewStatement) => {
    isOpen.value = false;
    query.value = "";
    onAdd?.(kind);
  };
  const clear = () => {
    if (query.value === "" && limit.value === "all") field.current?.blur();
    query.value = "";
    limit.value = "all";
    isOpen.value = false;
  };
  const press = (event: KeyboardEvent) => {
    const shown = Math.min(hits.value.length, SHOWN);
    const last = shown + additions.length - 1;
    const addition = additions[chosen.value - shown];
    if (event.key === "Enter") addition ? add(addition) : go(hits.value[chosen.value]);
    else if (event.key === "Escape") clear();
    else if (event.key === "ArrowDown") {
      chosen.value = isOpen.value ? Math.min(chosen.value + 1, last) : 0;
      isOpen.value = true;
    } else if (event.key === "ArrowUp") chosen.value = Math.max(chosen.value - 1, 0);
    else return;
    event.preventDefault();
  };
  return (
    <search
      class="rule-search"
      onFocusOut={(event) => {
        if (!event.currentTarget.contains(event.relatedTarget as Node | null)) isOpen.value = false;
      }}
    >
      <input
        ref={field}
        type="search"
        // biome-ignore lint/a11y/noRedundantRoles: its list is not a datalist
        role="combobox"
        list={undefined}
        aria-label="Find a rule"
        aria-expanded={isOpen.value}
        aria-controls="found-rules"
        aria-activedescendant={
          isOpen.value && hits.value.length + additions.length > 0 ? `found-rule-${chosen.value}` : undefined
        }
        placeholder="Find a rule ( / )"
        value={query.value}
        onFocus={() => (isOpen.value = true)}
        onInput={(event) => change(() => (query.value = event.currentTarget.value))}
        onKeyDown={press}
      />
      {isOpen.value && (
        <div class="found">
          <div class="row" role="group" aria-label="Limit the search">
            {LIMITS.filter(([each]) => each !== "holds" || robotRules.states.value.size > 0).map(([each, words]) => (
              <Button
                label={words}
                key={each}
                class="small"
                aria-pressed={limit.value === each}
                onClick={() => change(() => (limit.value = each))}
              />
            ))}
            <span role="status">
              {hits.value.length} of {editor.shownStatements.value.length}
            </span>
          </div>
          <FoundList hits={hits.value} {...{ additions, add }} chosen={chosen.value} onGo={go} />
        </div>
      )}
    </search>
  );
}

interface ListProps {
  hits: readonly Found[];
  additions: readonly NewStatement[];
  chosen: number;
  onGo(hit: Found): void;
  add(kind: NewStatement): void;
}

function FoundList({ hits, additions, chosen, onGo, add }: ListProps) {
  const shown = Math.min(hits.length, SHOWN);
  return (
    <>
      <div role="listbox" id="found-rules" aria-label="Rules that were found" tabIndex={-1}>
        {hits.slice(0, SHOWN).map((hit, at) => (
          <OptionRow key={hit.statement.id} id={`found-rule-${at}`} isChosen={at === chosen} act={() => onGo(hit)}>
            {statementTitle(hit.statement)}
            {hit.statement.kind === "rule" && hit.statement.is_disabled && <span class="quiet"> ⊘ switched off</span>}
          </OptionRow>
        ))}
        {additions.map((kind, at) => (
          <OptionRow key={kind} id={`found-rule-${shown + at}`} isChosen={shown + at === chosen} act={() => add(kind)}>
            <Icon name="plus" /> {NEW_STATEMENTS[kind]}
          </OptionRow>
        ))}
      </div>
      {hits.length > SHOWN && <p class="quiet">{hits.length - SHOWN} more: type more of what you look for.</p>}
    </>
  );
}

/** What can be added that is called so; nothing is offered before somebody types. */
function additionsOf(query: string): NewStatement[] {
  const words = query.trim().toLowerCase();
  const all = Object.keys(NEW_STATEMENTS) as NewStatement[];
  return words === "" ? [] : all.filter((kind) => NEW_STATEMENTS[kind].toLowerCase().includes(words));
}

/** "/" where nobody types, and Ctrl+F outside the text and dialogs, lead to the field. */
function useSearchKeys(field: { readonly current: HTMLInputElement | null }): void {
  const act = (event: KeyboardEvent) => {
    const target = event.target instanceof Element ? event.target : document.body;
    if (target.closest("dialog, .text-host") !== null) return;
    const isTyping = target.matches("input, textarea, select, .blocklyInputField, [contenteditable]");
    const isFind = (event.ctrlKey || event.metaKey) && shortcutKey(event) === "f";
    if (!isFind && (event.key !== "/" || isTyping || event.ctrlKey || event.metaKey || event.altKey)) return;
    event.preventDefault();
    event.stopPropagation();
    field.current?.focus();
    field.current?.select();
  };
  useWindowEvent("keydown", act, { capture: true });
}

/** What a search is limited to. */
type Limit = "all" | "off" | "findings" | "holds";

/** A statement that was found, with its number in the order of the text. */
interface Found {
  readonly index: number;
  readonly statement: Statement;
}

/** What is known of statements beside their words, by statement id. */
interface Known {
  findings: readonly PlacedFinding[];
  states: ReadonlyMap<string, RuleState>;
}

/** The statements in which every word of `query` stands in a name, comment, topic, property or rate. */
function found(all: readonly Statement[], query: string, limit: Limit, known: Known): Found[] {
  const words = query.toLowerCase().split(/\s+/).filter(Boolean);
  const isWithin = within(limit, known);
  return all
    .map((statement, index) => ({ statement, index }))
    .filter(({ statement }) => isWithin(statement))
    .filter(({ statement }) => {
      const text = saidIn(statement).join(" ").toLowerCase();
      return words.every((word) => text.includes(word));
    });
}

function within(limit: Limit, { findings, states }: Known): (statement: Statement) => boolean {
  switch (limit) {
    case "all":
      return () => true;
    case "off":
      return (statement) => statement.kind === "rule" && statement.is_disabled === true;
    case "findings": {
      const ids = new Set(findings.map(({ statement }) => statement));
      return ({ id }) => id !== undefined && ids.has(id);
    }
    case "holds":
      return ({ id }) => states.get(id ?? "")?.state === "true";
  }
}

/** What people look for in a statement: no keywords, which are in all of them. */
function saidIn(statement: Statement): string[] {
  const comments = statement.comments ?? [];
  switch (statement.kind) {
    case "rule": {
      const checks = checksOf(statement.condition).flatMap(({ topic, property, op, value }) => [
        topic,
        property,
        `${property} ${op} ${value}`,
      ]);
      const actions = [...statement.then, ...statement.else].map(actionWords);
      return [statement.name ?? statement.label ?? "", ...comments, ...checks, ...actions];
    }
    case "keep":
      return [...comments, statement.topic, `${statement.hz} Hz`];
    case "raw":
      return [...comments, statement.text];
    default:
      return [...comments, actionWords(statement)];
  }
}
