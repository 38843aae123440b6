// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";

/** A line of a list; the keyboard chooses where the list is controlled from, and not in the line. */
export function OptionRow(props: { id: string; isChosen: boolean; act: () => void; children: ComponentChildren }) {
  return (
    // biome-ignore lint/a11y/useKeyWithClickEvents: see above
    // biome-ignore lint/a11y/useFocusableInteractive: see above
    <div id={props.id} role="option" aria-selected={props.isChosen} onClick={props.act}>
      {props.children}
    </div>
  );
}
