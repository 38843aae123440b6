// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { LossPoint } from "../api/types";
import type { RateAxis } from "./rate_axis";

export const PLOT_HEIGHT_PX = 290;
/** Room above the curve, for the names of the levels. */
const HEADROOM = 1.15;

/** The error at each rate, on a logarithmic axis of rates; without points only that axis. `laid` gets its area. */
export function drawCurve(
  host: HTMLElement,
  points: readonly LossPoint[],
  axis: RateAxis,
  laid: (area: { left: number; width: number }) => void,
): uPlot {
  const style = getComputedStyle(host);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  const look = {
    stroke: colour("--text-2"),
    grid: { stroke: colour("--line"), width: 1 },
    font: `12px ${colour("--font")}`,
  };
  const errors = points.map((point) => point.error_percent);
  const most = Math.max(...errors.map((each) => each ?? 0), 1) * HEADROOM;
  const data =
    points.length > 0
      ? [points.map((point) => point.rate_hz), errors]
      : [
          [axis.low_hz, axis.high_hz],
          [null, null],
        ];
  return new uPlot(
    {
      width: host.clientWidth,
      height: PLOT_HEIGHT_PX,
      cursor: { show: false },
      legend: { show: false },
      // The plot lays itself out a little later.
      hooks: { ready: [({ over }) => laid({ left: over.offsetLeft, width: over.offsetWidth })] },
      scales: {
        x: { time: false, distr: 3, range: [axis.low_hz, axis.high_hz] },
        y: { range: [0, most] },
      },
      axes: [
        { ...look, label: "Rate (Hz)", labelSize: 22, labelFont: look.font, size: 30, filter: roundOnes },
        points.length > 0
          ? { ...look, label: "Error (% of the range)", labelSize: 22, labelFont: look.font, size: 44 }
          : { ...look, show: false },
      ],
      series: [{}, { stroke: colour("--accent"), width: 2, fill: colour("--accent-soft"), points: { size: 7 } }],
    },
    data as uPlot.AlignedData,
    host,
  );
}

/** Of the rates on the axis, those that are written: 1, 2, 5, 10, 20 … Hz. */
function roundOnes(_: uPlot, rates_hz: number[]): (number | null)[] {
  return rates_hz.map((rate) => ("125".includes(rate.toExponential(0).charAt(0)) ? rate : null));
}
