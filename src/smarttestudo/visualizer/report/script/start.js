// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// Puts everything in place; the static drawings stay underneath for paper.

const DRAWN = {
  rate: (figure, index) => rateChart(figure, data.topics[index]),
  total: totalChart,
  stack: stackedChart,
  lanes: lanesChart,
};

for (const figure of document.querySelectorAll("figure[data-chart]")) {
  const [kind, index] = figure.dataset.chart.split(" ");
  DRAWN[kind](figure, Number(index));
}
const map = document.querySelector("svg.map");
if (map && data.path.length) followOnMap(map);
document.querySelectorAll("table[data-sortable]").forEach(sortable);
document.querySelectorAll("tr[data-time]").forEach(movesCursor);
timeBar();
document.documentElement.classList.add("scripted");
time.tell();
