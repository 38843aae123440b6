// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { signal } from "@preact/signals";
import { useRef, useState } from "preact/hooks";
import { browserStorage, type DraftStorage } from "../state/drafts";
import { Icon } from "./button";

/** The parts that can have the whole page. */
type Part = "map" | "results";

/** Which part of the page has all of it, in a browser that fills the screen where it lets itself. */
export class FullScreen {
  readonly part = signal<Part | null>(null);

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

/** Gives a part of the page all of it, and takes it back. */
export function FullScreenButton({ full, part }: { full: FullScreen; part: Part }) {
  const isFull = full.part.value === part;
  const label = `${isFull ? "Leave full screen" : "Full screen"}: ${part}`;
  return (
    <button type="button" class="small" aria-label={label} title={label} onClick={() => full.toggle(part)}>
      <Icon name={isFull ? "leave" : "fit"} />
    </button>
  );
}

export type Side = "text" | "map";
export type Tool = "findings" | "try" | "robot";

export const TOOL_WORDS: Readonly<Record<Tool, string>> = {
  findings: "Findings",
  try: "Try on a recording",
  robot: "Robot",
};

const OPEN_KEY = "open panes";

/** What is unfolded beside and below the blocks: nothing at first, then what somebody left open in this browser. */
export class OpenPanes {
  readonly side = signal<Side | null>(null);
  readonly tool = signal<Tool | null>(null);

  constructor(private readonly storage = browserStorage()) {
    const [side, tool] = (storage.getItem(OPEN_KEY) ?? "").split(" ");
    if (side === "text" || side === "map") this.side.value = side;
    if (tool === "findings" || tool === "try" || tool === "robot") this.tool.value = tool;
  }

  open(pane: Side | Tool): void {
    if (pane === "text" || pane === "map") this.side.value = pane;
    else this.tool.value = pane;
    this.keep();
  }

  fold(part: "side" | "tool"): void {
    this[part].value = null;
    this.keep();
  }

  private keep(): void {
    store(this.storage, OPEN_KEY, `${this.side.value ?? "-"} ${this.tool.value ?? "-"}`);
  }
}

/** Keeps a look of the page, which a browser without room forgets with it. */
function store(storage: DraftStorage, key: string, value: string): void {
  try {
    storage.setItem(key, value);
  } catch {
    // It holds nothing but looks.
  }
}

const SIZE_KEY = "pane size of ";

/** How much room a pane has, in percent, as somebody left it in this browser, else `usual`; and how to set it. */
export function usePaneSize(pane: string, usual: number): [percent: number, set: (percent: number) => void] {
  const [sizes, setSizes] = useState<Readonly<Record<string, number>>>({});
  const storage = browserStorage();
  const left = storage.getItem(SIZE_KEY + pane);
  const set = (percent: number) => {
    setSizes({ ...sizes, [pane]: percent });
    store(storage, SIZE_KEY + pane, String(percent));
  };
  return [sizes[pane] ?? (left !== null && Number.isFinite(Number(left)) ? Number(left) : usual), set];
}

const STEP = 2;
const LARGE_STEP = 10;

interface Props {
  label: string;
  /** Of the line itself: a vertical one stands between left and right. */
  orientation: "vertical" | "horizontal";
  /** The share of the pane before the line, or of that below it, in percent. */
  percent: number;
  least: number;
  most: number;
  onChange: (percent: number) => void;
}

/** A line between two panes that the mouse, a finger or the arrow keys move. */
export function Splitter({ label, orientation, percent, least, most, onChange }: Props) {
  const line = useRef<HTMLDivElement>(null);
  const isVertical = orientation === "vertical";
  const set = (wanted: number) => onChange(Math.round(Math.min(Math.max(wanted, least), most) * 10) / 10);
  const follow = (event: PointerEvent) => {
    const room = line.current?.parentElement?.getBoundingClientRect();
    if (!line.current?.hasPointerCapture(event.pointerId) || !room) return;
    const share = isVertical ? (event.clientX - room.left) / room.width : (room.bottom - event.clientY) / room.height;
    set(share * 100);
  };
  const press = (event: KeyboardEvent) => {
    const wanted = wantedBy(event.key, isVertical, percent, least, most);
    if (wanted === null) return;
    event.preventDefault();
    set(wanted);
  };
  return (
    <div
      ref={line}
      class={`splitter ${orientation}`}
      role="separator"
      tabIndex={0}
      aria-label={label}
      aria-orientation={orientation}
      aria-valuenow={Math.round(percent)}
      aria-valuemin={least}
      aria-valuemax={most}
      onKeyDown={press}
      onPointerDown={(event) => {
        event.preventDefault();
        line.current?.focus();
        line.current?.setPointerCapture(event.pointerId);
      }}
      onPointerMove={follow}
    />
  );
}

/** Where a key moves the line; null where it is none of its keys. */
function wantedBy(key: string, isVertical: boolean, percent: number, least: number, most: number): number | null {
  const more = isVertical ? "ArrowRight" : "ArrowUp";
  const less = isVertical ? "ArrowLeft" : "ArrowDown";
  const steps: Record<string, number> = {
    [more]: percent + STEP,
    [less]: percent - STEP,
    PageUp: percent + LARGE_STEP,
    PageDown: percent - LARGE_STEP,
    Home: least,
    End: most,
  };
  return steps[key] ?? null;
}
