// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Signal } from "@preact/signals";

export interface Choice<T extends string> {
  value: T;
  label: string;
}

/** Tabs by the book: arrow keys move between them, Tab leaves them. */
export function Tabs<T extends string>(props: { label: string; choices: Choice<T>[]; chosen: Signal<T> }) {
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
