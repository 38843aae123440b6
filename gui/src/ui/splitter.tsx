// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useRef } from "preact/hooks";

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
