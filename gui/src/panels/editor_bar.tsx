// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Api } from "../api/client";
import type { Project } from "../api/types";
import { ShareButtons } from "../sharing/share_buttons";
import type { RobotRules } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import type { RulePush } from "../state/rule_push";
import { Header } from "../ui/header";
import { useRobot } from "../ui/robot_state";
import { NeedsServer } from "../ui/server_gone";

interface Props {
  editor: RuleEditor;
  api: Api;
  project: Project;
  savesByItself: boolean;
  rulePush: RulePush;
  robotRules: RobotRules;
  onTool: (tool: "try" | "robot") => void;
  onDownload: () => void;
}

/** What can be done with the rules, in three groups: work on them, try them, ship them. */
export function EditorBar({ editor, api, project, savesByItself, rulePush, robotRules, onTool, onDownload }: Props) {
  const { history } = editor;
  const next = useNextStep(editor, savesByItself, robotRules);
  const look = (step: NextStep) => (step === next ? "primary" : "");
  return (
    <Header title={editor.name} note={savedNote(editor, savesByItself)}>
      <div class="tool-group" role="group" aria-label="Work">
        <button type="button" disabled={!history.canUndo.value} onClick={() => editor.undo()}>
          Undo
        </button>
        <button type="button" disabled={!history.canRedo.value} onClick={() => editor.redo()}>
          Redo
        </button>
        <NeedsServer>
          <button type="button" onClick={() => void editor.format()}>
            Format
          </button>
          <NeedsServer changes>
            <button
              type="button"
              class={look("save")}
              disabled={editor.isSaved.value}
              onClick={() => void editor.save()}
            >
              Save
            </button>
          </NeedsServer>
          <ShareButtons {...{ editor, api, project }} />
        </NeedsServer>
      </div>
      <div class="tool-group" role="group" aria-label="Try">
        <button type="button" onClick={() => onTool("try")}>
          Try on a recording
        </button>
      </div>
      <div class="tool-group" role="group" aria-label="Ship">
        <NeedsServer>
          <NeedsServer changes>
            <button
              type="button"
              class={look("send")}
              onClick={() => {
                onTool("robot");
                void rulePush.ask();
              }}
            >
              Send to robot
            </button>
          </NeedsServer>
          <button type="button" class={look("download")} onClick={onDownload}>
            Optimize and Download
          </button>
        </NeedsServer>
      </div>
    </Header>
  );
}

type NextStep = "save" | "send" | "download" | null;

/** What is to be done next, as the one main button says; null while there is nothing that could be sent. */
function useNextStep(editor: RuleEditor, savesByItself: boolean, robotRules: RobotRules): NextStep {
  const { kind } = useRobot().connection.value;
  if (!editor.isSaved.value && !savesByItself) return "save";
  if (editor.isEmpty.value) return null;
  return kind === "connected" && robotRules.comparison.value.kind === "other" ? "send" : "download";
}

/** Whether the file holds what is open, and why it may not. */
function savedNote(editor: RuleEditor, savesByItself: boolean): string {
  if (editor.isSaved.value) return savesByItself ? "saved by itself" : "saved";
  const waits = savesByItself && editor.errors.value.length > 0;
  return waits ? "not saved while there are errors" : "not saved";
}
