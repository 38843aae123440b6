// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentProps } from "preact";
import { Icon, type IconName } from "./icon";

/** A button with words on it, which sends no form. */
export function Button({ label, ...how }: Omit<ComponentProps<"button">, "label"> & { label: string }) {
  return (
    <button type="button" {...how}>
      {label}
    </button>
  );
}

interface Props {
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
export function ToolButton({ label, short, icon, keys, isNext = false, disabled = false, act }: Props) {
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
