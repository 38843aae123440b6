// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { type Api, refusalOf } from "../api/client";
import { TIERS } from "../api/types";
import { LevelPanel } from "../levels/level_panel";
import { href } from "../route";
import { BagWork } from "../state/bag_work";
import type { OpenEditors } from "../state/open_editors";
import type { ProfileEditor } from "../state/profile_editor";
import { topicsIn } from "../state/statements";
import { type DraftRow, isNumber, type NumberField, tableCells } from "../state/topic_rows";
import { Button, ToolButton, UndoButtons } from "../ui/button";
import { NeedsServer, useReturn } from "../ui/connection";
import { FormDialog } from "../ui/dialog";
import { ConflictDialog, FileNotices, useOpenFile } from "../ui/file_notices";
import { Header } from "../ui/header";
import { useAnswer } from "../ui/later";
import { Notice, Toast, WorkProgress } from "../ui/notice";
import { useWindowEvent } from "../ui/watch";
import type { PageProps } from "./page_props";

/** The topic parameters: what the optimizer knows of each topic and of the link. */
export function TopicsPage({ project, name, rules, refresh, editors }: PageProps) {
  const editor = useMemo(() => editors.profileOf(name), []);
  editor.madeFor.value = rules ?? editor.madeFor.peek();
  const madeFor = editor.madeFor.value;
  const [problem, setProblem] = useState("");
  const isOpen = editor.isOpen.value;
  const guarded = async (work: () => Promise<void>) => {
    setProblem(await refusalOf(work));
  };
  const open = () => guarded(() => editor.open(project.files.some((file) => file.name === name)));
  useEffect(() => void open(), []);
  useReturn(() => (isOpen ? guarded(() => editor.revive()) : problem && open()));
  const canSave = () => (editor.isNew.value || !editor.isSaved.value) && editor.problems.value.length === 0;
  const save = () =>
    guarded(async () => {
      await editor.save();
      await refresh();
    });
  useOpenFile(editor, async () => (canSave() ? save() : undefined));
  const bags = project.files.filter((file) => file.kind === "bag").map((file) => file.name);
  const isSaved = editor.isSaved.value;
  return (
    <>
      <Header title="Topic parameters" note={`profile ${name}, ${noteOf(isSaved, editor.isNew.value)}`}>
        <NeedsServer changes>
          <ToolButton
            label="Save"
            icon={canSave() ? "save" : "saved"}
            keys="Ctrl+S"
            isNext
            disabled={!canSave()}
            act={() => void save()}
          />
        </NeedsServer>
        <UndoButtons
          canUndo={editor.history.canUndo.value}
          canRedo={editor.history.canRedo.value}
          undo={() => editor.undo()}
          redo={() => editor.redo()}
        />
      </Header>
      <main class="topics">
        <FileNotices file={editor} />
        {problem && <Notice kind="error" text={problem} />}
        {isOpen && madeFor !== null && <RulesTopics {...{ editors, editor }} rules={madeFor} />}
        <Measuring {...{ editor, bags }} />
        {isOpen && <TopicTable editor={editor} />}
        {isOpen && <LevelPanel {...{ editor, bags }} />}
        <Toast message={editor.message} />
        <ConflictDialog file={editor} />
      </main>
    </>
  );
}

function noteOf(isSaved: boolean, isNew: boolean): string {
  if (isNew) return "new, not saved";
  return isSaved ? "saved" : "not saved";
}

/** Fills the table from a recording or a robot, with its progress; nothing of the table changes before the end. */
function Measuring({ editor, bags }: { editor: ProfileEditor; bags: string[] }) {
  const work = useMemo(() => new BagWork<void>(), []);
  useEffect(() => () => work.cancel(), []);
  const isRunning = work.state.value.kind === "running";
  return (
    <div class="row">
      {!isRunning && (
        <NeedsServer>
          {bags.length > 0 && (
            <MeasureChoice
              bags={bags}
              measure={(bag) => work.start((run, signal) => editor.measure(bag, run, signal))}
            />
          )}
          <NeedsServer changes>
            <MeasureRobot
              measure={(seconds) => work.start((run, signal) => editor.measureLive(seconds, run, signal))}
            />
          </NeedsServer>
        </NeedsServer>
      )}
      {!isRunning && <PresetChoice editor={editor} />}
      <WorkProgress work={work} doing="Measuring" />
    </div>
  );
}

function MeasureChoice({ bags, measure }: { bags: string[]; measure: (bag: string) => Promise<void> }) {
  return (
    <label class="row">
      Measure in
      <select
        value=""
        onChange={(event) => {
          const bag = event.currentTarget.value;
          if (bag) void measure(bag);
        }}
      >
        <option value="">a recording …</option>
        {bags.map((bag) => (
          <option key={bag}>{bag}</option>
        ))}
      </select>
    </label>
  );
}

const USUAL_S = 10;
const LONGEST_S = 60;

/** Asks for how long to listen to the robot, and then measures its topics. */
function MeasureRobot({ measure }: { measure: (seconds: number) => Promise<void> }) {
  const [isAsking, setAsking] = useState(false);
  return (
    <>
      <Button label="Measure on the robot" onClick={() => setAsking(true)} />
      {isAsking && (
        <FormDialog
          title="Measure on the robot"
          submit="Measure"
          onSubmit={(form) => measure(Number(form.get("seconds")))}
          onClose={() => setAsking(false)}
        >
          <label>
            Seconds
            <input name="seconds" type="number" min={1} max={LONGEST_S} step="any" value={USUAL_S} required autofocus />
          </label>
          <p class="quiet">
            Sizes and rates of all topics that the robot publishes now. It takes every message of every topic meanwhile:
            do not do this over a slow radio.
          </p>
        </FormDialog>
      )}
    </>
  );
}

/** Fills the table from what is known of usual robots and sensors. */
function PresetChoice({ editor }: { editor: ProfileEditor }) {
  const [isAsking, setAsking] = useState(false);
  return (
    <NeedsServer>
      <Button label="From a preset" onClick={() => setAsking(true)} />
      {isAsking && <PresetDialog editor={editor} onClose={() => setAsking(false)} />}
    </NeedsServer>
  );
}

function PresetDialog({ editor, onClose }: { editor: ProfileEditor; onClose: () => void }) {
  const { answer, problem } = useAnswer(() => editor.api.ask("GET /api/profile/presets", null));
  if (answer === null) return <p class={problem ? "problem" : "quiet"}>{problem || "Loading …"}</p>;
  const fill = async (form: FormData) => {
    const preset = answer.presets.find(({ title }) => title === form.get("preset"));
    if (preset) await editor.fill(preset);
    onClose();
  };
  return (
    <FormDialog title="From a preset" submit="Fill" isWide onSubmit={fill} onClose={onClose}>
      <p class="quiet">
        What is in the table stays. The rest is marked <em>not measured</em> until you measure or type it.
      </p>
      <fieldset class="checklist" aria-label="Preset">
        {answer.presets.map(({ title, about }, at) => (
          <label key={title}>
            <input type="radio" name="preset" value={title} defaultChecked={at === 0} autofocus={at === 0} />
            <span>
              <strong>{title}</strong>: {about}
            </span>
          </label>
        ))}
      </fieldset>
    </FormDialog>
  );
}

interface Props {
  editors: OpenEditors;
  editor: ProfileEditor;
  /** The rule file that the table is for. */
  rules: string;
}

/** The way back to the rules, and a row for each topic of them that the table lacks; a new table begins with those. */
function RulesTopics({ editors, editor, rules }: Props) {
  const { answer: topics, problem } = useAnswer(() => topicsOf(editor.api, editors, rules));
  useEffect(() => {
    const isEmpty = editor.rows.peek().every((row) => row.topic.trim() === "");
    if (editor.isNew.peek() && editor.isSaved.peek() && isEmpty && topics?.length) editor.begin(topics);
  }, [topics]);
  const known = new Set(editor.rows.value.map((row) => row.topic.trim()));
  const missing = (topics ?? []).filter((topic) => !known.has(topic));
  return (
    <div class="row">
      <a href={href({ page: "rules", name: rules })}>Back to {rules}</a>
      {problem && <p class="problem">{problem}</p>}
      {missing.length > 0 && (
        <>
          <p role="status">
            {missing.length === 1 ? "1 topic of the rules is" : `${missing.length} topics of the rules are`} not in the
            table.
          </p>
          <Button
            label={`Add ${missing.length === 1 ? missing[0] : "them"}`}
            class="small"
            onClick={() => editor.addTopics(missing)}
          />
        </>
      )}
    </div>
  );
}

async function topicsOf(api: Api, editors: OpenEditors, rules: string): Promise<string[]> {
  const text = editors.unsavedText(rules) ?? (await api.read(rules)).text;
  return [...topicsIn(await api.ask("POST /api/document", { text, name: rules, profile_text: null }))].sort();
}

/** The thesis's table of topic parameters, filled by hand or pasted from a spreadsheet. */
function TopicTable({ editor }: { editor: ProfileEditor }) {
  const problems = editor.problems.value;
  usePastedTable(editor);
  const body = useRef<HTMLTableSectionElement>(null);
  const wantsFocus = useRef(false);
  const add = () => {
    wantsFocus.current = true;
    editor.addRow();
  };
  useEffect(() => {
    if (wantsFocus.current) body.current?.querySelector<HTMLInputElement>("tr:last-child input")?.focus();
    wantsFocus.current = false;
  }, [editor.rows.value.length]);
  return (
    <>
      <div class="row budget">
        <label>
          Budget: total bandwidth (KB/s)
          <input
            inputMode="decimal"
            value={editor.budget.value}
            placeholder="such as 15000"
            aria-invalid={!isNumber(editor.budget.value)}
            onInput={(event) => editor.setBudget(event.currentTarget.value)}
          />
        </label>
        <p class="quiet">1 KB is 1000 bytes. A table copied from a spreadsheet can be pasted here.</p>
      </div>
      <div class="table-scroll">
        <table class="topic-table">
          <TableHead />
          <tbody ref={body} onKeyDown={(event) => goOn(event, add)}>
            {editor.rows.value.map((row, index) => (
              <TopicRow key={row.key} editor={editor} row={row} number={index + 1} />
            ))}
          </tbody>
        </table>
      </div>
      <Button label="Add topic" onClick={add} />
      <ul class="problems" aria-label="Problems" aria-live="polite">
        {problems.map((problem) => (
          <li key={problem} class="problem">
            {problem}
          </li>
        ))}
      </ul>
    </>
  );
}

/** Enter goes on to the next cell, and behind the last one to a new row. */
function goOn(event: KeyboardEvent & { currentTarget: HTMLElement }, add: () => void): void {
  if (event.key !== "Enter" || !(event.target instanceof HTMLInputElement)) return;
  event.preventDefault();
  const cells = [...event.currentTarget.querySelectorAll("input")];
  const next = cells[cells.indexOf(event.target) + 1];
  next?.select();
  if (next === undefined) add();
}

function TableHead() {
  return (
    <thead>
      <tr>
        <th scope="col">Topic</th>
        <th scope="col">Message size (KB)</th>
        {TIERS.map((tier, index) => (
          <th key={tier} scope="col">
            {tier}, {index < TIERS.length - 1 ? "up to" : "from"} (Hz)
          </th>
        ))}
        <th scope="col">Priority</th>
        <th scope="col">Source (Hz)</th>
        <th scope="col">
          <span class="visually-hidden">Remove</span>
        </th>
      </tr>
    </thead>
  );
}

interface RowProps {
  editor: ProfileEditor;
  row: DraftRow;
  number: number;
}

/** A row, drawn anew only where it changed: a table may have many. */
function TopicRow({ editor, row, number }: RowProps) {
  return useMemo(() => <TopicCells {...{ editor, row, number }} />, [editor, row, number]);
}

function TopicCells({ editor, row, number }: RowProps) {
  const of = row.topic || `row ${number}`;
  const cell = (label: string, value: string, change: (text: string) => Partial<DraftRow>, placeholder = "") => (
    <td>
      <input
        inputMode="decimal"
        aria-label={`${label} of ${of}`}
        aria-invalid={!isNumber(value)}
        value={value}
        placeholder={placeholder}
        onInput={(event) => editor.change(row.key, change(event.currentTarget.value))}
      />
    </td>
  );
  const field = (name: NumberField) => (text: string) => ({ [name]: text });
  return (
    <tr>
      <th scope="row">
        <input
          class="topic"
          aria-label={`Topic of row ${number}`}
          value={row.topic}
          title={row.topic}
          placeholder="/topic"
          spellcheck={false}
          onInput={(event) => editor.change(row.key, { topic: event.currentTarget.value })}
          onPaste={(event) => pasteTable(event, editor, row.key)}
        />
        {row.measured === false && <span class="quiet not-measured">not measured</span>}
      </th>
      {cell("Message size (KB)", row.message_kb, field("message_kb"))}
      {TIERS.map((tier, index) =>
        cell(`${tier} (Hz)`, row.tiers_hz[index] ?? "", (text) => ({ tiers_hz: row.tiers_hz.with(index, text) })),
      )}
      {cell("Priority", row.priority, field("priority"), "1 if empty")}
      {cell("Source (Hz)", row.source_hz, field("source_hz"))}
      <td>
        <Button label="−" class="small" aria-label={`Remove ${of}`} onClick={() => editor.removeRow(row.key)} />
      </td>
    </tr>
  );
}

/** Takes a pasted table from a row on, or with null each line where its topic is; other text is left to the browser. */
function pasteTable(event: ClipboardEvent, editor: ProfileEditor, key: number | null): void {
  const cells = tableCells(event.clipboardData?.getData("text/plain") ?? "");
  if (cells.length === 0 || event.defaultPrevented) return;
  event.preventDefault();
  editor.paste(key, cells);
}

/** Takes a table that is pasted anywhere on the page, but into no field. */
function usePastedTable(editor: ProfileEditor): void {
  useWindowEvent("paste", (event) => {
    const isField = event.target instanceof Element && event.target.closest("input, select, dialog") !== null;
    if (!isField) pasteTable(event, editor, null);
  });
}
