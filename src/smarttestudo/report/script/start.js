// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// Puts everything in place; what is drawn is there already.

const READOUTS = { rate: linesReadout, total: linesReadout, stack: layersReadout };
const told = { leading: [], total: null };

for (const figure of document.querySelectorAll("figure[data-chart]")) {
  const drawing = figure.querySelector("svg");
  const kind = figure.dataset.chart;
  timeChart(drawing);
  if (kind === "lanes") {
    const { bars, leading } = lanesOf(drawing);
    nameBars(drawing, bars);
    told.leading = leading;
    continue;
  }
  const words = READOUTS[kind](drawing);
  figureReadout(figure, words);
  if (kind === "total") told.total = words;
}
const map = document.querySelector("svg.map");
if (map && data.path.length) followOnMap(map);
document.querySelectorAll("table[data-sortable]").forEach(sortable);
document.querySelectorAll("tr[data-time]").forEach(movesCursor);
timeBar(told);
document.documentElement.classList.add("scripted");
time.tell();
