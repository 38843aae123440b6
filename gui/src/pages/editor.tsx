// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, type Signal, useComputed, useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect, useMemo, useState } from "preact/hooks";
import { ApiError } from "../api/client";
import { BlocksPane } from "../panels/blocks_pane";
import { FindingsPanel } from "../panels/findings_panel";
import { OptimizePanel } from "../panels/optimize_panel";
import { ProfileChoice } from "../panels/profile_choice";
import { RobotPanel } from "../panels/robot_panel";
import { SendDialog } from "../panels/send_dialog";
import { SidePane } from "../panels/side_pane";
import { TryPanel } from "../panels/try_panel";
import { toRoute } from "../route";
import { ShareButtons } from "../sharing/share_buttons";
import { BagWork } from "../state/bag_work";
import { RobotRules } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { RulePush } from "../state/rule_push";
import { type SelfSaving, saveByItself } from "../state/save_by_itself";
import type { Trial } from "../state/trial";
import { ConflictDialog } from "../ui/conflict_dialog";
import { Header } from "../ui/header";
import { Notice } from "../ui/notice";
import { RestoredNotice } from "../ui/restored_notice";
import { useRobot } from "../ui/robot_state";
import { type Choice, Tabs } from "../ui/tabs";
import { Toast } from "../ui/toast";
import { useUndoKeys } from "../ui/undo_keys";
import type { PageProps } from "./page_props";

export type Tool = "findings" | "optimize" | "try" | "robot";

/** Blocks and text of one rule file side by side, and below them what can be said about it. */
export function EditorPage({ api, project, name, robot: node, editors, refresh }: PageProps) {
  const editor = useMemo(() => editors.of(api, name), []);
  const robot = useRobotSide(api, editor);
  const tries = useMemo(() => new BagWork<Trial>(), []);
  useEffect(() => () => tries.cancel(), []);
  const tool = useSignal<Tool>("findings");
  useShownRobot(node, tool);
  const [state, setState] = useState<"opening" | "open" | { problem: string }>("opening");
  useEffect(() => void open(editor, setState), []);
  useUndoKeys(editor);
  const savesByItself = project.saves_by_itself && state === "open";
  useEffect(() => (savesByItself ? saveByItself(selfSaving(editor)) : undefined), [savesByItself]);
  if (state === "opening") return <p class="quiet center">Opening {name} …</p>;
  if (state !== "open") return <Notice kind="error" text={state.problem} />;
  return (
    <div class="editor">
      <div>
        <EditorBar
          editor={editor}
          savesByItself={savesByItself}
          rulePush={robot.rulePush}
          onTool={(next) => (tool.value = next)}
        >
          <ShareButtons {...{ editor, api, project }} />
        </EditorBar>
        <RestoredNotice file={editor} />
      </div>
      <main class="split">
        <BlocksPane editor={editor} robotRules={robot.robotRules} />
        <SidePane {...{ editor, api }} />
      </main>
      <section class="dock" aria-label="Results">
        <div class="dock-bar">
          <Tabs label="Results" choices={useChoices(editor).value} chosen={tool} />
          <ProfileChoice {...{ editor, api, project }} />
        </div>
        <div class="dock-body" role="tabpanel" aria-label={tool.value}>
          {tool.value === "findings" && <FindingsPanel editor={editor} />}
          {tool.value === "optimize" && <OptimizePanel {...{ editor, api }} />}
          {tool.value === "robot" && <RobotPanel {...{ editor, ...robot }} />}
          {tool.value === "try" && <TryPanel {...{ editor, api, project }} work={tries} />}
        </div>
      </section>
      <Toast message={editor.message} />
      <ConflictDialog
        api={api}
        file={editor}
        onSavedAs={(saved) => refresh().then(() => toRoute({ page: "rules", name: saved }))}
      />
      <SendDialog rulePush={robot.rulePush} />
    </div>
  );
}

/** Turns to the robot that the address names. */
function useShownRobot(node: string | undefined, tool: Signal<Tool>): void {
  const link = useRobot();
  useEffect(() => {
    if (node === undefined) return;
    link.choose(node);
    tool.value = "robot";
  }, [node]);
}

/** What links the open rules with a running robot, for as long as the page is open. */
function useRobotSide(api: PageProps["api"], editor: RuleEditor): { robotRules: RobotRules; rulePush: RulePush } {
  const link = useRobot();
  const side = useMemo(
    () => ({ robotRules: new RobotRules(api, editor, link), rulePush: new RulePush(api, editor, link) }),
    [],
  );
  useEffect(() => side.robotRules.follow(), []);
  useEffect(() => side.rulePush.follow(), []);
  return side;
}

interface BarProps {
  editor: RuleEditor;
  savesByItself: boolean;
  rulePush: RulePush;
  onTool: (tool: Tool) => void;
  children: ComponentChildren;
}

function EditorBar({ editor, savesByItself, rulePush, onTool, children }: BarProps) {
  const { history } = editor;
  return (
    <Header title={editor.name} note={savedNote(editor, savesByItself)}>
      <button type="button" disabled={!history.canUndo.value} onClick={() => editor.undo()}>
        Undo
      </button>
      <button type="button" disabled={!history.canRedo.value} onClick={() => editor.redo()}>
        Redo
      </button>
      <button type="button" onClick={() => void editor.format()}>
        Format
      </button>
      <button type="button" disabled={editor.isSaved.value} onClick={() => void editor.save()}>
        Save
      </button>
      {children}
      <span class="divider" />
      <button type="button" onClick={() => onTool("try")}>
        Try on a bag
      </button>
      <button
        type="button"
        onClick={() => {
          onTool("robot");
          void rulePush.ask();
        }}
      >
        Send to robot
      </button>
      <button type="button" class="primary" onClick={() => onTool("optimize")}>
        Optimize and Download
      </button>
    </Header>
  );
}

/** Whether the file holds what is open, and why it may not. */
function savedNote(editor: RuleEditor, savesByItself: boolean): string {
  if (editor.isSaved.value) return savesByItself ? "saved by itself" : "saved";
  const waits = savesByItself && editor.errors.value.length > 0;
  return waits ? "not saved while there are errors" : "not saved";
}

function useChoices(editor: RuleEditor) {
  return useComputed((): Choice<Tool>[] => [
    { value: "findings", label: `Findings (${editor.findings.value.length})` },
    { value: "optimize", label: "Optimize" },
    { value: "try", label: "Try on a bag" },
    { value: "robot", label: "Robot" },
  ]);
}

function selfSaving(editor: RuleEditor): SelfSaving {
  const { isSaved, conflict, restored } = editor;
  const content = computed(() => JSON.stringify([editor.text.value, editor.layout.value, editor.map.value]));
  return { content, isSaved, conflict, restored, isSound: () => editor.isSound(), save: () => editor.save(true) };
}

type Opened = "open" | { problem: string };

async function open(editor: RuleEditor, done: (state: Opened) => void): Promise<void> {
  try {
    if (!editor.isOpen) await editor.open();
    done("open");
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    done({ problem: error.message });
  }
}
