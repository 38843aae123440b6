// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, signal } from "@preact/signals";

const PREFIX = "pane size of ";

/** How much room panes have, in percent, as somebody left them in this browser. */
export class PaneSizes {
  /** What was set, by the name of a pane. */
  private readonly sizes = new Map<string, Signal<number | null>>();

  constructor(private readonly storage: Pick<Storage, "getItem" | "setItem">) {}

  /** The share of a pane; null where nobody set it. */
  of(pane: string): number | null {
    return this.signalOf(pane).value;
  }

  /** Sets the share of a pane, and remembers it. */
  set(pane: string, percent: number): void {
    this.signalOf(pane).value = percent;
    try {
      this.storage.setItem(`${PREFIX}${pane}`, String(percent));
    } catch {
      // A browser without room forgets it with the page.
    }
  }

  private signalOf(pane: string): Signal<number | null> {
    const known = this.sizes.get(pane);
    if (known) return known;
    const text = this.storage.getItem(`${PREFIX}${pane}`);
    const percent = text === null ? Number.NaN : Number(text);
    const size = signal(Number.isFinite(percent) ? percent : null);
    this.sizes.set(pane, size);
    return size;
  }
}
