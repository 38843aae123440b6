// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { RuleEditor } from "../state/rule_editor";
import { type OpenPanes, type Side, TOOL_WORDS, type Tool } from "../ui/panes";
import { showOnNarrow } from "../ui/watch";

interface Props {
  editor: RuleEditor;
  panes: OpenPanes;
  onTool: (tool: Tool) => void;
}

/** What unfolds beside and below the blocks, and folds again: the same buttons in the same place, whatever is open. */
export function PaneButtons({ editor, panes, onTool }: Props) {
  const [side, tool] = [panes.side.value, panes.tool.value];
  const count = editor.isChecked.value ? editor.findings.value.length : "…";
  const isWrong = editor.errors.value.length > 0;
  const toggleSide = (pane: Side) => {
    if (side === pane) return panes.fold("side");
    panes.open(pane);
    showOnNarrow(() => document.querySelector(".side"));
  };
  return (
    <div class="pane-buttons" role="group" aria-label="Unfold">
      <Toggle words="Text" isOpen={side === "text"} act={() => toggleSide("text")} />
      <Toggle words="Map" isOpen={side === "map"} act={() => toggleSide("map")} />
      <Toggle
        words={`Findings (${count})`}
        isOpen={tool === "findings"}
        isWrong={isWrong}
        act={() => onTool("findings")}
      />
      <Toggle words="Try" label={TOOL_WORDS.try} isOpen={tool === "try"} act={() => onTool("try")} />
      <Toggle words="Robot" isOpen={tool === "robot"} act={() => onTool("robot")} />
    </div>
  );
}

interface ToggleProps {
  words: string;
  /** All of it, where the words are a part. */
  label?: string;
  isOpen: boolean;
  isWrong?: boolean;
  act: () => void;
}

function Toggle({ words, label = words, isOpen, isWrong = false, act }: ToggleProps) {
  return (
    <button
      type="button"
      class={isWrong ? "small problem" : "small"}
      aria-expanded={isOpen}
      aria-label={label}
      title={label}
      onClick={act}
    >
      {words}
    </button>
  );
}
