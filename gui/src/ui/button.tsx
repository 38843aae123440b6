// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentProps } from "preact";

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

/** Lines on a square of 16, as SVG paths: they need no font. */
const PATHS = {
  undo: "M6 3 2.5 6.5 6 10M2.5 6.5H10a3.5 3.5 0 0 1 0 7H6",
  redo: "M10 3l3.5 3.5L10 10M13.5 6.5H6a3.5 3.5 0 0 0 0 7h4",
  save: "M2.5 2.5h8.5l2.5 2.5v8.5h-11zM5 2.5v4h5.5v-4M4.5 13.5v-4h7v4",
  saved: "M2.5 8.5 6 12l7.5-8",
  send: "M2 8l12-5.5L10 14 7.5 9zM7.5 9 14 2.5",
  download: "M8 2v8.5M4.5 7 8 10.5 11.5 7M2.5 13.5h11",
  menu: "M2.5 4h11M2.5 8h11M2.5 12h11",
  book: "M8 4C6.5 2.8 4.5 2.5 2 2.5V12c2.5 0 4.5.3 6 1.5 1.5-1.2 3.5-1.5 6-1.5V2.5c-2.5 0-4.5.3-6 1.5zM8 4v9.5",
  keys: "M1.5 4.5h13v7.5h-13zM4 7h.01M6.7 7h.01M9.3 7h.01M12 7h.01M5 9.7h6",
  versions: "M8 2.5a5.5 5.5 0 1 0 .01 0M8 5v3.5l2 1.5",
  warning: "M8 2.5 14.5 13.5h-13zM8 6.5v3.5M8 11.9v.2",
  before: "M11.5 2.5v11L3 8z",
  after: "M4.5 2.5v11L13 8z",
  plus: "M8 3v10M3 8h10",
  minus: "M3 8h10",
  fit: "M9.5 2.5h4v4M13.5 2.5l-4.5 4.5M6.5 13.5h-4v-4M2.5 13.5 7 9",
  leave: "M13.5 6.5h-4v-4M9 7l4.5-4.5M2.5 9.5h4v4M7 9l-4.5 4.5",
  more: "M3 8h.01M8 8h.01M13 8h.01",
  rules: "M2.5 2.5h7v4h-7zM4.5 6.5v7M4.5 9h9v4.5h-9",
  topics: "M2.5 3.5h11v9h-11zM2.5 6.5h11M6.5 3.5v9",
  robot: "M3 6.5h10v6.5H3zM8 6.5V3M6.5 3h3M5.8 9h.01M10.2 9h.01M5.5 11h5M1.5 8.5v2.5M14.5 8.5v2.5",
  incident: "M8 1.5a6.5 6.5 0 1 0 0 13a6.5 6.5 0 1 0 0-13zM8 4.5v4.2M8 11v.2",
  recording: "M2 8c1-4 2-4 3 0s2 4 3 0s2-4 3 0s2 4 3 0",
} as const;

export type IconName = keyof typeof PATHS;

/** A drawing beside words that say the same; alone, its button needs a label. */
export function Icon({ name }: { name: IconName }) {
  return (
    <svg class="icon" viewBox="0 0 16 16" width="16" height="16" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}
