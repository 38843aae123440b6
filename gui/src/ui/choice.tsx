// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";

interface Props<T extends string | number> {
  label: string;
  value: T;
  /** Values with what is written of them; a value alone is written as it is. */
  choices: readonly (T | readonly [T, string])[];
  choose: (value: T) => void;
  /** Whether the label is not to be seen. */
  isBare?: boolean;
  disabled?: boolean;
}

/** One of some values, in a list of the browser's own. */
export function Choice<T extends string | number>(props: Props<T>) {
  const { label, value, isBare = false, disabled } = props;
  const choices = props.choices.map((each) => (typeof each === "object" ? each : ([each, String(each)] as const)));
  const list = (
    <select
      aria-label={isBare ? label : undefined}
      value={value}
      disabled={disabled}
      onChange={({ currentTarget }) => {
        const chosen = choices[currentTarget.selectedIndex];
        if (chosen) props.choose(chosen[0]);
      }}
    >
      {choices.map(([each, words]) => (
        <option key={each} value={each}>
          {words}
        </option>
      ))}
    </select>
  );
  if (isBare) return list;
  return (
    // biome-ignore lint/a11y/noLabelWithoutControl: the list is in it
    <label>
      {label}
      {list}
    </label>
  );
}

export interface Tab<T extends string> {
  value: T;
  label: string;
}

/** Tabs by the book: arrow keys move between them, Tab leaves them. */
export function Tabs<T extends string>(props: { label: string; choices: Tab<T>[]; chosen: Signal<T> }) {
  const { choices, chosen } = props;
  const move = (event: KeyboardEvent, index: number) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const next = step === undefined ? undefined : choices[(index + step + choices.length) % choices.length];
    if (!next) return;
    chosen.value = next.value;
    const tabs = (event.currentTarget as HTMLElement).parentElement?.children;
    (tabs?.[choices.indexOf(next)] as HTMLElement | undefined)?.focus();
  };
  return (
    <div role="tablist" aria-label={props.label} class="tabs">
      {choices.map((choice, index) => {
        const selected = chosen.value === choice.value;
        return (
          <button
            key={choice.value}
            type="button"
            role="tab"
            aria-selected={selected}
            tabIndex={selected ? 0 : -1}
            onClick={() => (chosen.value = choice.value)}
            onKeyDown={(event) => move(event, index)}
          >
            {choice.label}
          </button>
        );
      })}
    </div>
  );
}
