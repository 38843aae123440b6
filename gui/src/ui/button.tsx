// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentProps } from "preact";
import type { FullScreen } from "../state/room";
import { Icon, type IconName } from "./icon";

/** A button with words on it, which sends no form. */
export function Button({ label, ...how }: Omit<ComponentProps<"button">, "label"> & { label: string }) {
  return (
    <button type="button" {...how}>
      {label}
    </button>
  );
}

interface ToolProps {
  label: string;
  /** The part of the label that is shown where there is little room; none is shown without it. */
  short?: string;
  icon: IconName;
  /** The keys that do the same. */
  keys?: string;
  isNext?: boolean;
  disabled?: boolean;
  act: () => void;
}

/** A button of the bar on top: an icon and words, of which as many are shown as there is room for. */
export function ToolButton({ label, short, icon, keys, isNext = false, disabled = false, act }: ToolProps) {
  return (
    <button
      type="button"
      class={isNext ? "primary" : ""}
      title={keys === undefined ? label : `${label} (${keys})`}
      aria-label={label}
      aria-keyshortcuts={keys}
      disabled={disabled}
      onClick={act}
    >
      <Icon name={icon} />
      <span class="word">{label}</span>
      {short !== undefined && <span class="short-word">{short}</span>}
    </button>
  );
}

/** Undo and redo of what a page changes. */
export function UndoButtons(props: { canUndo: boolean; canRedo: boolean; undo: () => void; redo: () => void }) {
  const { canUndo, canRedo, undo, redo } = props;
  return (
    <div class="tool-group" role="group" aria-label="Undo and redo">
      <ToolButton label="Undo" icon="undo" keys="Ctrl+Z" disabled={!canUndo} act={undo} />
      <ToolButton label="Redo" icon="redo" keys="Ctrl+Shift+Z" disabled={!canRedo} act={redo} />
    </div>
  );
}

interface FullScreenProps<Part extends string> {
  full: FullScreen<Part>;
  part: Part;
  /** What the part is called, for those who do not see it. */
  what: string;
}

/** Gives a part of the page all of it, and takes it back. */
export function FullScreenButton<Part extends string>({ full, part, what }: FullScreenProps<Part>) {
  const isFull = full.part.value === part;
  const label = isFull ? "Leave full screen" : "Full screen";
  return (
    <Button
      label={label}
      class="small full-screen-button"
      aria-label={`${label}: ${what}`}
      onClick={() => full.toggle(part)}
    />
  );
}
