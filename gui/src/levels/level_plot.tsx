// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { useEffect, useRef, useState } from "preact/hooks";
import { TIERS } from "../api/types";
import { readable } from "../ui/numbers";
import { styleOf, watchSize, watchTheme } from "../ui/watch";
import { axisOf, type LevelAxis, type LevelKind, limitsOf, rounded, shareOf, stepOf, valueAt } from "./level_axis";

/** The six levels of a topic as lines that can be dragged, over a chart where there is one. */
export function LevelPlot(props: {
  /** The topic, with the property where the levels are accuracies. */
  of: string;
  kind: LevelKind;
  levels: readonly number[] | null;
  chart: Chart | null;
  axisLabel: string;
  move: (index: number, value: number, goesOn: boolean) => void;
  /** Somebody points at a value, or has the focus on the level of it. */
  pointed?: (value: number) => void;
}) {
  const { kind, levels, chart, axisLabel, move, pointed = () => undefined } = props;
  const host = useRef<HTMLDivElement>(null);
  const [area, setArea] = useState({ left: 0, width: 0 });
  const [isDragging, setDragging] = useState(false);
  const wanted = axisOf([...(chart?.at ?? []), ...(levels ?? [])]);
  // While a line is dragged the axis under it must stand still.
  const axis = useRef(wanted);
  if (!isDragging) axis.current = wanted;
  const { low, high } = axis.current;
  useEffect(() => {
    const element = host.current;
    if (!element) return;
    const draw = () => drawCurve(element, chart, { low, high }, axisLabel, setArea);
    let plot = draw();
    const again = () => {
      plot.destroy();
      plot = draw();
    };
    const stops = [watchSize(element, again), watchTheme(again)];
    return () => {
      for (const stop of stops) stop();
      plot.destroy();
    };
  }, [chart, axisLabel, low, high]);
  return (
    <div class="level-plot">
      <div ref={host} class="level-host" aria-hidden="true" />
      {levels && (
        <div
          class="level-area"
          style={{ left: `${area.left}px`, width: `${area.width}px` }}
          onPointerMove={(event) => {
            const { left, width } = event.currentTarget.getBoundingClientRect();
            pointed(rounded(valueAt(axis.current, (event.clientX - left) / width)));
          }}
        >
          <LevelLines of={props.of} {...{ kind, levels, move, pointed }} axis={axis.current} dragging={setDragging} />
        </div>
      )}
    </div>
  );
}

const BIG_STEP = 10;
/** A finger that scrolls the page goes this far to the side before the browser takes it. */
const STILL_PX = 4;

/** The six levels as lines over a plot, each a slider. `move` says whether it goes on with the step before. */
function LevelLines(props: {
  /** The topic, with the property where the levels are accuracies. */
  of: string;
  kind: LevelKind;
  levels: readonly number[];
  axis: LevelAxis;
  move: (index: number, value: number, goesOn: boolean) => void;
  pointed: (value: number) => void;
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
        return (
          <div
            key={tier}
            class="level-line"
            style={`left: ${100 * shareOf(props.axis, value)}%`}
            role="slider"
            tabIndex={0}
            aria-label={`${tier} level of ${props.of} (${unit})`}
            aria-valuemin={least}
            aria-valuemax={most}
            aria-valuenow={value}
            aria-valuetext={`${readable(value)} ${unit}`}
            onFocus={() => props.pointed(value)}
            onPointerDown={(event) => press(event, index)}
            onPointerMove={follow}
            onPointerUp={release}
            onPointerCancel={release}
            onKeyDown={(event) => {
              const next = valueForKey(event.key, value, least, most);
              if (next === null) return;
              event.preventDefault();
              props.move(index, next, false);
              props.pointed(next);
            }}
          />
        );
      })}
      <LevelBands kind={props.kind} levels={props.levels} axis={props.axis} />
    </div>
  );
}

/**
 * What each level covers: rates up to its line, from that of the level below; errors down to it. The last one begins at
 * its line.
 */
function LevelBands({ kind, levels, axis }: { kind: LevelKind; levels: readonly number[]; axis: LevelAxis }) {
  return TIERS.map((tier, index) => {
    const at = (value: number | undefined, end: number) => (value === undefined ? end : shareOf(axis, value));
    const isLast = index === TIERS.length - 1;
    const [below, above] = isLast ? [levels[index], undefined] : [levels[index - 1], levels[index]];
    const [from, to] = kind.falls ? [at(above, 0), at(below, 1)] : [at(below, 0), at(above, 1)];
    const until = isLast ? "from" : kind.falls ? "down to" : "up to";
    const text = `${tier}, ${until} ${readable(levels[index] ?? 0)} ${kind.unit}`;
    return (
      <div
        key={tier}
        class="level-band"
        style={`left: ${100 * from}%; width: ${100 * (to - from)}%; --level: ${index + 1}`}
        title={text}
        aria-hidden="true"
      >
        <span>{text}</span>
      </div>
    );
  });
}

function valueForKey(key: string, value: number, least: number, most: number): number | null {
  const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: BIG_STEP, PageDown: -BIG_STEP }[key];
  const step = stepOf(value);
  if (steps !== undefined) return Math.max(Number((Math.round(value / step + steps) * step).toPrecision(6)), 0);
  return { Home: least, End: most }[key] ?? null;
}

const PLOT_HEIGHT_PX = 290;
/** Room above the curve, for the names of the levels. */
const HEADROOM = 1.15;

/** What is drawn over an axis of levels: at each of rising values one value of each line; later lines are dashed. */
export interface Chart {
  at: readonly number[];
  lines: readonly (readonly (number | null)[])[];
  label: string;
}

/** A chart on a logarithmic axis, which `axisLabel` names; without a chart only that axis. `laid` gets its area. */
function drawCurve(
  host: HTMLElement,
  chart: Chart | null,
  axis: LevelAxis,
  axisLabel: string,
  laid: (area: { left: number; width: number }) => void,
): uPlot {
  const colour = styleOf(host);
  const look = {
    stroke: colour("--text-2"),
    grid: { stroke: colour("--line"), width: 1 },
    font: `12px ${colour("--font")}`,
  };
  const lines = chart?.lines ?? [[null, null]];
  const most = Math.max(...lines.flat().map((each) => each ?? 0), 1) * HEADROOM;
  const data = [chart?.at ?? [axis.low, axis.high], ...lines];
  return new uPlot(
    {
      width: host.clientWidth,
      height: PLOT_HEIGHT_PX,
      cursor: { show: false },
      legend: { show: false },
      // The plot lays itself out a little later.
      hooks: { ready: [({ over }) => laid({ left: over.offsetLeft, width: over.offsetWidth })] },
      scales: { x: { time: false, distr: 3, range: [axis.low, axis.high] }, y: { range: [0, most] } },
      axes: [
        { ...look, label: axisLabel, labelSize: 22, labelFont: look.font, size: 30, filter: roundOnes },
        chart
          ? { ...look, label: chart.label, labelSize: 22, labelFont: look.font, size: 44 }
          : { ...look, show: false },
      ],
      series: [
        {},
        ...lines.map((_, index) =>
          index === 0
            ? { stroke: colour("--accent"), width: 2, fill: colour("--accent-soft"), points: { size: 7 } }
            : { stroke: colour("--text"), width: 2, dash: [6, 4], points: { size: 7 } },
        ),
      ],
    },
    data as uPlot.AlignedData,
    host,
  );
}

/** Of the values on the axis, those that are written: 1, 2, 5, 10, 20 … */
function roundOnes(_: uPlot, values: number[]): (number | null)[] {
  return values.map((each) => ("125".includes(each.toExponential(0).charAt(0)) ? each : null));
}
