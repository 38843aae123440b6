// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useRef } from "preact/hooks";
import { TIERS } from "../api/types";
import { readable } from "../ui/numbers";
import { type LevelAxis, type LevelKind, limitsOf, rounded, shareOf, stepOf, valueAt } from "./level_axis";

const BIG_STEP = 10;
/** A finger that scrolls the page goes this far to the side before the browser takes it. */
const STILL_PX = 4;
/** Beyond this share of the axis a name stands on the left of its line. */
const FLIP_AT = 0.75;

/** The six levels as lines over a plot, each a slider. `move` says whether it goes on with the step before. */
export function LevelLines(props: {
  /** The topic, with the property where the levels are accuracies. */
  of: string;
  kind: LevelKind;
  levels: readonly number[];
  axis: LevelAxis;
  move: (index: number, value: number, goesOn: boolean) => void;
  /** Somebody drags, or has stopped to. */
  dragging: (isDragging: boolean) => void;
}) {
  const { unit } = props.kind;
  const area = useRef<HTMLDivElement>(null);
  const drag = useRef<{ index: number; hasMoved: boolean; fromPx: number; besidePx: number } | null>(null);
  const press = (event: PointerEvent, index: number) => {
    (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId);
    const box = area.current?.getBoundingClientRect();
    const line = box ? box.left + box.width * shareOf(props.axis, props.levels[index] ?? 0) : event.clientX;
    drag.current = { index, hasMoved: false, fromPx: event.clientX, besidePx: event.clientX - line };
    props.dragging(true);
  };
  const follow = (event: PointerEvent) => {
    const box = area.current?.getBoundingClientRect();
    if (!drag.current || !box) return;
    const { index, hasMoved, fromPx, besidePx } = drag.current;
    const isFinger = event.pointerType === "touch";
    if (isFinger && !hasMoved && Math.abs(event.clientX - fromPx) < STILL_PX) return;
    const share = (event.clientX - besidePx - box.left) / box.width;
    props.move(index, rounded(valueAt(props.axis, share)), hasMoved);
    drag.current.hasMoved = true;
  };
  const release = () => {
    drag.current = null;
    props.dragging(false);
  };
  return (
    <div class="level-lines" ref={area}>
      {TIERS.map((tier, index) => {
        const value = props.levels[index] ?? 0;
        const [least, most] = limitsOf(props.kind, props.levels, index);
        const share = shareOf(props.axis, value);
        return (
          <div
            key={tier}
            class={share > FLIP_AT ? "level-line flipped" : "level-line"}
            style={`left: ${100 * share}%; --row: ${index}`}
            role="slider"
            tabIndex={0}
            aria-label={`${tier} level of ${props.of} (${unit})`}
            aria-valuemin={least}
            aria-valuemax={most}
            aria-valuenow={value}
            aria-valuetext={`${readable(value)} ${unit}`}
            onPointerDown={(event) => press(event, index)}
            onPointerMove={follow}
            onPointerUp={release}
            onPointerCancel={release}
            onKeyDown={(event) => {
              const next = valueForKey(event.key, value, least, most);
              if (next === null) return;
              event.preventDefault();
              props.move(index, next, false);
            }}
          >
            <span>
              {tier} {readable(value)} {unit}
            </span>
          </div>
        );
      })}
    </div>
  );
}

function valueForKey(key: string, value: number, least: number, most: number): number | null {
  const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: BIG_STEP, PageDown: -BIG_STEP }[key];
  const step = stepOf(value);
  if (steps !== undefined) return Math.max(Number((Math.round(value / step + steps) * step).toPrecision(6)), 0);
  return { Home: least, End: most }[key] ?? null;
}
