// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { LevelAxis } from "./level_axis";

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
export function drawCurve(
  host: HTMLElement,
  chart: Chart | null,
  axis: LevelAxis,
  axisLabel: string,
  laid: (area: { left: number; width: number }) => void,
): uPlot {
  const style = getComputedStyle(host);
  const colour = (name: string) => style.getPropertyValue(name).trim();
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
      scales: {
        x: { time: false, distr: 3, range: [axis.low, axis.high] },
        y: { range: [0, most] },
      },
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
