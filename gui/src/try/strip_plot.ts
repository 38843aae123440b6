// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Trial } from "../state/trial";
import { watchSize, watchTheme } from "../ui/watch";

const HEIGHT_PX = 104;
type Values = readonly (number | null)[];

/** A chart over the recording's time: `before`, if given, thin and dashed, `after` filled; the scrubber is a line. */
export function openStrip(host: HTMLElement, trial: Trial, lines: { before?: Values; after: Values }): () => void {
  let plot = draw(host, trial, lines);
  let follow = drawTime(plot, trial);
  const close = () => {
    follow();
    plot.destroy();
  };
  const again = () => {
    close();
    plot = draw(host, trial, lines);
    follow = drawTime(plot, trial);
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

function draw(host: HTMLElement, trial: Trial, { before, after }: { before?: Values; after: Values }): uPlot {
  const style = getComputedStyle(host);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  const axis = {
    stroke: colour("--text-2"),
    grid: { stroke: colour("--line"), width: 1 },
    font: `11px ${colour("--font")}`,
  };
  const sent = { stroke: colour("--accent"), width: 2, fill: colour("--accent-soft"), points: { show: false } };
  const recorded = { stroke: colour("--text-2"), width: 1, dash: [4, 3], points: { show: false } };
  const times = trial.binTimes;
  const values = before ? [times, before, after] : [times, after];
  return new uPlot(
    {
      width: host.clientWidth,
      height: HEIGHT_PX,
      cursor: { sync: { key: "try" }, drag: { x: false, y: false }, y: false, points: { show: false } },
      scales: {
        x: { time: false, range: [0, trial.durationS] },
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

/** Keeps a line at the time of the scrubber, which pressing and dragging on the chart moves. */
function drawTime(plot: uPlot, trial: Trial): () => void {
  const line = document.createElement("div");
  line.className = "strip-now";
  plot.over.append(line);
  const place = () => {
    line.style.left = `${plot.valToPos(trial.time.value, "x")}px`;
  };
  plot.hooks.setSize = [...(plot.hooks.setSize ?? []), place];
  const scrub = (event: PointerEvent) => {
    if (event.buttons !== 1) return;
    plot.over.setPointerCapture(event.pointerId);
    trial.goTo(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, "x"));
  };
  plot.over.addEventListener("pointerdown", scrub);
  plot.over.addEventListener("pointermove", scrub);
  return effect(place);
}
