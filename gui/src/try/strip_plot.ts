// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Timeline } from "../state/timeline";
import { watchSize, watchTheme } from "../ui/watch";

const HEIGHT_PX = 104;
type Values = readonly (number | null)[];

/** What a chart shows, bin by bin: `before`, if given, thin and dashed, `after` filled. */
export interface StripLines {
  before?: Values;
  after: Values;
}

/** A chart over the recording's time; the scrubber is a line. */
export function openStrip(host: HTMLElement, timeline: Timeline, lines: StripLines): () => void {
  let plot = draw(host, timeline, lines);
  let follow = drawTime(plot, timeline);
  const close = () => {
    follow();
    plot.destroy();
  };
  const again = () => {
    close();
    plot = draw(host, timeline, lines);
    follow = drawTime(plot, timeline);
  };
  const stops = [
    watchSize(host, () => plot.setSize({ width: host.clientWidth, height: HEIGHT_PX })),
    watchTheme(again),
  ];
  return () => {
    for (const stop of stops) stop();
    close();
  };
}

function draw(host: HTMLElement, timeline: Timeline, { before, after }: StripLines): uPlot {
  const style = getComputedStyle(host);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  const axis = {
    stroke: colour("--text-2"),
    grid: { stroke: colour("--line"), width: 1 },
    font: `11px ${colour("--font")}`,
  };
  const sent = { stroke: colour("--accent"), width: 2, fill: colour("--accent-soft"), points: { show: false } };
  const recorded = { stroke: colour("--text-2"), width: 1, dash: [4, 3], points: { show: false } };
  const { zeroS } = timeline;
  const times = timeline.binTimes.map((t) => t - zeroS);
  const values = before ? [times, before, after] : [times, after];
  return new uPlot(
    {
      width: host.clientWidth,
      height: HEIGHT_PX,
      cursor: { sync: { key: "try" }, drag: { x: false, y: false }, y: false, points: { show: false } },
      scales: {
        x: { time: false, range: [-zeroS, timeline.durationS - zeroS] },
        y: { range: (_, __, most) => [0, (most || 1) * 1.08] },
      },
      legend: { show: false },
      axes: [
        { ...axis, size: 24 },
        { ...axis, size: 46 },
      ],
      series: before ? [{}, recorded, sent] : [{}, sent],
    },
    values as uPlot.AlignedData,
    host,
  );
}

/** Keeps a line at the time of the scrubber, which pressing and dragging on the chart moves, and one at each mark. */
function drawTime(plot: uPlot, timeline: Timeline): () => void {
  const { zeroS } = timeline;
  const line = lineOn(plot, "strip-now");
  const marks = timeline.marksS.map((markS) => ({ markS, line: lineOn(plot, "strip-mark") }));
  const put = (element: HTMLElement, timeS: number) => {
    element.style.left = `${plot.valToPos(timeS - zeroS, "x")}px`;
  };
  const place = () => {
    put(line, timeline.time.value);
    for (const { markS, line } of marks) put(line, markS);
  };
  plot.hooks.setSize = [...(plot.hooks.setSize ?? []), place];
  const scrub = (event: PointerEvent) => {
    if (event.buttons !== 1) return;
    plot.over.setPointerCapture(event.pointerId);
    timeline.goTo(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x") + zeroS);
  };
  plot.over.addEventListener("pointerdown", scrub);
  plot.over.addEventListener("pointermove", scrub);
  return effect(place);
}

function lineOn(plot: uPlot, name: string): HTMLElement {
  const line = document.createElement("div");
  line.className = name;
  plot.over.append(line);
  return line;
}
