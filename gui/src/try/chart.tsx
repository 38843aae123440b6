// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { effect, type Signal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import type { Timeline } from "../state/timeline";
import { readable } from "../ui/numbers";
import { styleOf, watchSize, watchTheme } from "../ui/watch";
import { Lane } from "./axis";

/** A lane with numbers over the time. `lines` must stay the same object while they are the same. */
export function Chart(props: { timeline: Timeline; lines: ChartLines; label: string; children: ComponentChildren }) {
  const { timeline, lines, label, children } = props;
  const host = useRef<HTMLDivElement>(null);
  const opened = useRef<OpenChart | null>(null);
  useEffect(() => {
    if (host.current === null) return;
    opened.current = openChart(host.current, timeline, lines);
    return opened.current.close;
  }, [timeline, lines.threshold, lines.isFixed]);
  useEffect(() => opened.current?.show(lines), [lines]);
  return (
    <Lane timeline={timeline} label={label} caption={children}>
      <div ref={host} class="chart" />
    </Lane>
  );
}

const HEIGHT_PX = 104;
/** A line that is dragged needs more room. */
const DRAGGED_HEIGHT_PX = 180;
/** How much higher a chart is than what it shows. */
const ROOM = 1.08;
/** What may be between two words below a chart that tells minutes. */
const MINUTES_S = [60, 120, 300, 600, 1200, 1800];
type Values = readonly (number | null)[];

/** What a chart shows, bin by bin: `before`, if given, thin and dashed, `after` filled down to `least`, or to 0. */
interface ChartLines {
  before?: Values;
  after: Values;
  least?: Values;
  /** The times of the values, where they are not the timeline's. */
  timesS?: readonly number[];
  /** A value that can be dragged, unless it `isFixed`. */
  threshold?: Signal<number>;
  isFixed?: boolean;
  /** What a time on the axis is called, to the minute, where that is not its number of seconds. */
  timeWords?: (timeS: number) => string;
}

/** A chart that is open: `show` gives it other values of the same kinds. */
interface OpenChart {
  show(lines: ChartLines): void;
  close(): void;
}

function openChart(host: HTMLElement, timeline: Timeline, first: ChartLines): OpenChart {
  let lines = first;
  const now = () => lines;
  const { threshold, isFixed = false } = first;
  const open = () => {
    const plot = draw(host, timeline, now);
    return { plot, stop: threshold ? drawThreshold(plot, threshold, isFixed) : () => {} };
  };
  let { plot, stop } = open();
  const close = () => {
    stop();
    plot.destroy();
  };
  const again = () => {
    close();
    ({ plot, stop } = open());
  };
  const stops = [
    watchSize(host, () => plot.setSize({ width: host.clientWidth, height: heightOf(lines) })),
    watchTheme(again),
  ];
  return {
    show: (next) => {
      if (next === lines) return;
      lines = next;
      plot.setData(dataOf(timeline, lines));
    },
    close: () => {
      for (const stop of stops) stop();
      close();
    },
  };
}

function heightOf({ threshold }: ChartLines): number {
  return threshold ? DRAGGED_HEIGHT_PX : HEIGHT_PX;
}

/** The least and the greatest of what a chart of a band and a threshold shows, with room around them. */
function limits({ after, least = [], threshold }: ChartLines): [number, number] {
  const all = [...least, ...after, threshold?.peek() ?? null].filter((value) => value !== null);
  const [low, high] = all.reduce(
    ([a, b], value) => [Math.min(a, value), Math.max(b, value)],
    [all[0] ?? 0, all[0] ?? 0],
  );
  const room = (ROOM - 1) * (high - low || Math.abs(high) || 1);
  return [low - room, high + room];
}

function dataOf(timeline: Timeline, { before, after, least, timesS }: ChartLines): uPlot.AlignedData {
  const times = (timesS ?? timeline.binTimes).map((t) => t - timeline.zeroS);
  const other = before ?? least;
  return [times, ...(other ? [[...other]] : []), [...after]];
}

function draw(host: HTMLElement, timeline: Timeline, lines: () => ChartLines): uPlot {
  const { before, least, timeWords } = lines();
  const colour = styleOf(host);
  const axis = {
    stroke: colour("--text-2"),
    grid: { stroke: colour("--line"), width: 1 },
    font: `11px ${colour("--font")}`,
  };
  const words = timeWords && { values: (_: uPlot, times: number[]) => times.map(timeWords), incrs: MINUTES_S };
  const sent = { stroke: colour("--accent"), width: 2, fill: colour("--accent-soft"), points: { show: false } };
  const recorded = { stroke: colour("--text-2"), width: 1, dash: [4, 3], points: { show: false } };
  const { zeroS } = timeline;
  const edge = { stroke: sent.stroke, width: 1, points: sent.points };
  // The plot is exactly as wide as its lane, whatever its numbers are.
  const [left, right] = ["--axis-left", "--axis-right"].map((name) => Number.parseFloat(colour(name)));
  return new uPlot(
    {
      width: host.clientWidth,
      height: heightOf(lines()),
      padding: [8, right ?? 0, 0, 0],
      cursor: { show: false },
      scales: {
        x: { time: false, range: [-zeroS, timeline.durationS - zeroS] },
        y: { range: least ? () => limits(lines()) : (_, __, most) => [0, (most || 1) * ROOM] },
      },
      legend: { show: false },
      axes: [
        { ...axis, ...words, size: 24 },
        { ...axis, size: left ?? 0 },
      ],
      series: before ? [{}, recorded, sent] : least ? [{}, edge, edge] : [{}, sent],
      bands: least ? [{ series: [2, 1], fill: colour("--accent-soft") }] : [],
    },
    dataOf(timeline, lines()),
    host,
  );
}

const STEPS: Readonly<Record<string, number>> = { ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10 };

/** A number of so many digits as a range of values needs: one 200th of it can be told. */
function rounded(value: number, range: number): number {
  const step = stepOf(range);
  return Number((Math.round(value / step) * step).toPrecision(12));
}

function stepOf(range: number): number {
  return range > 0 ? 10 ** Math.floor(Math.log10(range / 50)) : 1;
}

/** A line at `value` until the returned function is called; unless it `isFixed`, it is dragged, and moved with the arrow keys. */
function drawThreshold(plot: uPlot, value: Signal<number>, isFixed: boolean): () => void {
  const line = document.createElement("div");
  line.className = isFixed ? "threshold-line fixed" : "threshold-line";
  plot.over.append(line);
  const ends = (): readonly [number, number] => {
    const { y } = plot.scales;
    return [y?.min ?? 0, y?.max ?? 1];
  };
  const move = (to: number) => {
    const [least, most] = ends();
    value.value = rounded(Math.min(Math.max(to, least), most), most - least);
  };
  const place = () => {
    const [least, most] = ends();
    line.style.top = `${plot.valToPos(Math.min(Math.max(value.value, least), most), "y")}px`;
    if (isFixed) return;
    line.setAttribute("aria-valuemin", String(rounded(least, most - least)));
    line.setAttribute("aria-valuemax", String(rounded(most, most - least)));
    line.setAttribute("aria-valuenow", String(value.value));
    line.setAttribute("aria-valuetext", readable(value.value));
  };
  plot.hooks.draw = [...(plot.hooks.draw ?? []), place];
  if (isFixed) return effect(place);
  line.tabIndex = 0;
  line.setAttribute("role", "slider");
  line.setAttribute("aria-label", "Threshold");
  line.setAttribute("aria-orientation", "vertical");
  line.addEventListener("pointerdown", (event) => {
    event.stopPropagation();
    line.setPointerCapture(event.pointerId);
  });
  line.addEventListener("pointermove", (event) => {
    event.stopPropagation();
    if (event.buttons !== 1 || !line.hasPointerCapture(event.pointerId)) return;
    move(plot.posToVal(event.clientY - plot.over.getBoundingClientRect().top, "y"));
  });
  line.addEventListener("keydown", (event) => {
    const steps = STEPS[event.key];
    if (steps === undefined) return;
    event.preventDefault();
    const [least, most] = ends();
    move(value.peek() + steps * stepOf(most - least));
  });
  return effect(place);
}
