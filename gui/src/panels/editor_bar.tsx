// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useSignal } from "@preact/signals";
import type { RobotRules, RulePush } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { ToolButton, UndoButtons } from "../ui/button";
import { NeedsServer, useRobot } from "../ui/connection";
import { FormDialog } from "../ui/dialog";
import { Header, MenuItem } from "../ui/header";
import { VersionsPane } from "./versions_pane";

const SEND = "Send to robot";
const DOWNLOAD = "Optimize and Download";

interface Props {
  editor: RuleEditor;
  rulePush: RulePush;
  robotRules: RobotRules;
  onSend: () => void;
  onDownload: () => void;
}

/** What can be done with the rules: keep them, go back, and send or download them; the rest is in the menu. */
export function EditorBar({ editor, rulePush, robotRules, onSend, onDownload }: Props) {
  const { history } = editor;
  const hasVersions = useSignal(false);
  const closeVersions = () => (hasVersions.value = false);
  const next = useNextStep(editor, robotRules);
  const send = () => {
    onSend();
    void editor.format().then(() => rulePush.ask());
  };
  const isSaved = editor.isSaved.value;
  const menu = (
    <>
      <NeedsServer>
        <MenuItem label="Versions" icon="versions" act={() => (hasVersions.value = true)} />
      </NeedsServer>
      <hr />
    </>
  );
  return (
    <>
      <Header title={editor.name} note={editor.isSaved.value ? "saved" : "not saved"} menu={menu}>
        <NeedsServer changes>
          <ToolButton
            label="Save"
            icon={isSaved ? "saved" : "save"}
            keys="Ctrl+S"
            isNext={next === "save"}
            disabled={isSaved}
            act={() => void editor.save()}
          />
        </NeedsServer>
        <UndoButtons
          canUndo={history.canUndo.value}
          canRedo={history.canRedo.value}
          undo={() => editor.undo()}
          redo={() => editor.redo()}
        />
        <div class="tool-group" role="group" aria-label="Send or download">
          <NeedsServer changes>
            <ToolButton label={SEND} short="Send" icon="send" isNext={next === "send"} act={send} />
          </NeedsServer>
          <NeedsServer>
            <ToolButton
              label={DOWNLOAD}
              short="Download"
              icon="download"
              isNext={next === "download"}
              act={onDownload}
            />
          </NeedsServer>
        </div>
      </Header>
      {hasVersions.value && (
        <FormDialog title="Versions" submit="Close" isNotice isWide onSubmit={closeVersions} onClose={closeVersions}>
          <VersionsPane editor={editor} />
        </FormDialog>
      )}
    </>
  );
}

type NextStep = "save" | "send" | "download" | null;

/** What is to be done next, which alone has colour: each button stays what it is. Null while there is nothing to be done. */
function useNextStep(editor: RuleEditor, robotRules: RobotRules): NextStep {
  const { kind } = useRobot().connection.value;
  if (!editor.isSaved.value) return "save";
  if (editor.isEmpty.value) return null;
  if (kind === "none") return "download";
  return robotRules.comparison.value.kind === "other" ? "send" : null;
}
