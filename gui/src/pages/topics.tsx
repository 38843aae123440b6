// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from "preact/hooks";
import { type Api, refusalOf } from "../api/client";
import { LevelPanel } from "../levels/level_panel";
import { TopicTable } from "../panels/topic_table";
import { href, toRoute } from "../route";
import type { OpenEditors } from "../state/open_editors";
import type { ProfileEditor } from "../state/profile_editor";
import { topicsIn } from "../state/statements";
import { Button, ToolButton, UndoButtons } from "../ui/button";
import { NeedsServer, useReturn } from "../ui/connection";
import { FormDialog } from "../ui/dialog";
import { ConflictDialog, FileNotices, useOpenFile } from "../ui/file_notices";
import { Header } from "../ui/header";
import { useAnswer } from "../ui/later";
import { Notice, Toast } from "../ui/notice";
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
  const save = (byItself: boolean) =>
    guarded(async () => {
      await editor.save(byItself);
      await refresh();
    });
  useOpenFile(editor, project, async (byItself) => (byItself || canSave() ? save(byItself) : undefined));
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
            act={() => void save(false)}
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
        <div class="row">
          <NeedsServer>
            {bags.length > 0 && <MeasureChoice bags={bags} measure={(bag) => guarded(() => editor.measure(bag))} />}
            <NeedsServer changes>
              <MeasureRobot measure={(seconds) => guarded(() => editor.measureLive(seconds))} />
            </NeedsServer>
          </NeedsServer>
        </div>
        {isOpen && <TopicTable editor={editor} />}
        {isOpen && <LevelPanel {...{ editor, bags }} />}
        <Toast message={editor.message} />
        <ConflictDialog
          file={editor}
          onSavedAs={(saved) => refresh().then(() => toRoute({ page: "topics", name: saved }))}
        />
      </main>
    </>
  );
}

function noteOf(isSaved: boolean, isNew: boolean): string {
  if (isNew) return "new, not saved";
  return isSaved ? "saved" : "not saved";
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
  const [runningS, setRunning] = useState<number | null>(null);
  const run = async (seconds: number) => {
    setAsking(false);
    setRunning(seconds);
    await measure(seconds);
    setRunning(null);
  };
  return (
    <>
      <Button
        label={runningS === null ? "Measure on the robot" : `Measuring for ${runningS} s …`}
        disabled={runningS !== null}
        onClick={() => setAsking(true)}
      />
      {isAsking && (
        <FormDialog
          title="Measure on the robot"
          submit="Measure"
          onSubmit={(form) => run(Number(form.get("seconds")))}
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
