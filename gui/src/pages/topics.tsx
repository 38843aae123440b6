// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";
import { refusalOf } from "../api/refusal";
import { LevelPanel } from "../levels/level_panel";
import { MeasureRobot } from "../panels/measure_robot";
import { RulesTopics } from "../panels/rules_topics";
import { TopicTable } from "../panels/topic_table";
import { toRoute } from "../route";
import { saveByItself } from "../state/save_by_itself";
import { ConflictDialog } from "../ui/conflict_dialog";
import { Header } from "../ui/header";
import { Notice } from "../ui/notice";
import { RestoredNotice } from "../ui/restored_notice";
import { DiskNotice, NeedsServer, useDiskLooks, useReturn } from "../ui/server_gone";
import { Toast } from "../ui/toast";
import { ToolButton, UndoButtons } from "../ui/tool_button";
import { useUndoKeys } from "../ui/undo_keys";
import type { PageProps } from "./page_props";

/** The topic parameters: what the optimizer knows of each topic and of the link. */
export function TopicsPage({ api, project, name, rules, refresh, editors }: PageProps) {
  const editor = useMemo(() => editors.profileOf(api, name), []);
  const [problem, setProblem] = useState("");
  const [isOpen, setOpen] = useState(false);
  const guarded = async (work: () => Promise<void>) => {
    setProblem(await refusalOf(work));
  };
  useEffect(() => void guarded(() => editor.open(project.files).then(() => setOpen(true))), []);
  useDiskLooks(editor, isOpen);
  useReturn(() => guarded(() => editor.lookAtDisk()));
  const canSave = () => (editor.isNew.value || !editor.isSaved.value) && editor.problems.value.length === 0;
  const save = () =>
    guarded(async () => {
      const wasNew = editor.isNew.peek();
      await editor.save();
      // A table that was made for rules is theirs from now on, for everybody.
      if (wasNew && !editor.isNew.peek() && rules !== undefined) await api.chooseProfile(rules, name);
      await refresh();
    });
  useUndoKeys({
    undo: () => editor.undo(),
    redo: () => editor.redo(),
    save: async () => (canSave() ? save() : undefined),
  });
  const savesByItself = project.saves_by_itself && isOpen;
  useEffect(() => {
    const { isSaved, conflict, restored } = editor;
    const content = computed(() => JSON.stringify([editor.rows.value, editor.budget.value]));
    const isSound = () => editor.problems.peek().length === 0;
    return savesByItself ? saveByItself({ content, isSaved, conflict, restored, isSound, save }) : undefined;
  }, [savesByItself]);
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
        <RestoredNotice file={editor} />
        <DiskNotice file={editor} />
        {problem && <Notice kind="error" text={problem} />}
        {isOpen && rules !== undefined && <RulesTopics {...{ api, editors, editor, rules }} />}
        <div class="row">
          <NeedsServer>
            {bags.length > 0 && <MeasureChoice bags={bags} measure={(bag) => guarded(() => editor.measure(bag))} />}
            <NeedsServer changes>
              <MeasureRobot measure={(seconds) => guarded(() => editor.measureLive(seconds))} />
            </NeedsServer>
          </NeedsServer>
        </div>
        {isOpen && <TopicTable editor={editor} />}
        {isOpen && <LevelPanel {...{ editor, api, bags }} />}
        <Toast message={editor.message} />
        <ConflictDialog
          api={api}
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
