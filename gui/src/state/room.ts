// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, signal } from "@preact/signals";

/** Which part of the page has all of it, in a browser that fills the screen where it lets itself. */
export class FullScreen<Part extends string> {
  readonly part: Signal<Part | null> = signal(null);

  /** Gives a part the whole page, or takes it back. */
  toggle(part: Part): void {
    if (this.part.peek() === part) this.leave();
    else this.enter(part);
  }

  leave(): void {
    this.part.value = null;
    if (document.fullscreenElement !== null) void document.exitFullscreen();
  }

  /** Leaves with Escape, as the browser's own does; returns how to stop, which leaves it, too. */
  follow(): () => void {
    const left = () => {
      if (document.fullscreenElement === null) this.part.value = null;
    };
    const pressed = (event: KeyboardEvent) => {
      if (event.key === "Escape" && !event.defaultPrevented && document.querySelector("dialog[open]") === null) {
        this.leave();
      }
    };
    document.addEventListener("fullscreenchange", left);
    addEventListener("keydown", pressed);
    return () => {
      document.removeEventListener("fullscreenchange", left);
      removeEventListener("keydown", pressed);
      this.leave();
    };
  }

  private enter(part: Part): void {
    this.part.value = part;
    // Where the browser refuses, the part still fills its window.
    document.documentElement.requestFullscreen?.().catch(() => undefined);
  }
}

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
