// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useRef } from "preact/hooks";
import { TIERS } from "../api/types";
import { readable } from "../ui/numbers";
import { limitsOf, type RateAxis, rateAt, roundRate, shareOf, stepOf } from "./rate_axis";

const BIG_STEP = 10;
/** Beyond this share of the axis a name stands on the left of its line. */
const FLIP_AT = 0.75;

/** The six levels as lines over a plot, each a slider. `move` says whether it goes on with the step before. */
export function LevelLines(props: {
  topic: string;
  levels_hz: readonly number[];
  axis: RateAxis;
  move: (index: number, rate_hz: number, goesOn: boolean) => void;
  /** Somebody drags, or has stopped to. */
  dragging: (isDragging: boolean) => void;
}) {
  const area = useRef<HTMLDivElement>(null);
  const drag = useRef<{ index: number; hasMoved: boolean; besidePx: number } | null>(null);
  const press = (event: PointerEvent, index: number) => {
    (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId);
    const box = area.current?.getBoundingClientRect();
    const line = box ? box.left + box.width * shareOf(props.axis, props.levels_hz[index] ?? 0) : event.clientX;
    drag.current = { index, hasMoved: false, besidePx: event.clientX - line };
    props.dragging(true);
  };
  const follow = (event: PointerEvent) => {
    const box = area.current?.getBoundingClientRect();
    if (!drag.current || !box) return;
    const { index, hasMoved, besidePx } = drag.current;
    const share = (event.clientX - besidePx - box.left) / box.width;
    props.move(index, roundRate(rateAt(props.axis, share)), hasMoved);
    drag.current.hasMoved = true;
  };
  const release = () => {
    drag.current = null;
    props.dragging(false);
  };
  return (
    <div class="level-lines" ref={area}>
      {TIERS.map((tier, index) => {
        const rate_hz = props.levels_hz[index] ?? 0;
        const [least, most] = limitsOf(props.levels_hz, index);
        const share = shareOf(props.axis, rate_hz);
        return (
          <div
            key={tier}
            class={share > FLIP_AT ? "level-line flipped" : "level-line"}
            style={`left: ${100 * share}%; --row: ${index}`}
            role="slider"
            tabIndex={0}
            aria-label={`${tier} level of ${props.topic} (Hz)`}
            aria-valuemin={least}
            aria-valuemax={most}
            aria-valuenow={rate_hz}
            aria-valuetext={`${readable(rate_hz)} Hz`}
            onPointerDown={(event) => press(event, index)}
            onPointerMove={follow}
            onPointerUp={release}
            onPointerCancel={release}
            onKeyDown={(event) => {
              const next = rateForKey(event.key, rate_hz, least, most);
              if (next === null) return;
              event.preventDefault();
              props.move(index, next, false);
            }}
          >
            <span>
              {tier} {readable(rate_hz)} Hz
            </span>
          </div>
        );
      })}
    </div>
  );
}

function rateForKey(key: string, rate_hz: number, least: number, most: number): number | null {
  const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: BIG_STEP, PageDown: -BIG_STEP }[key];
  const step = stepOf(rate_hz);
  if (steps !== undefined) return Math.max(Number((Math.round(rate_hz / step + steps) * step).toPrecision(6)), 0);
  return { Home: least, End: most }[key] ?? null;
}
