// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// The rule that decided each topic, and the rate that it gave, as bars over time.

const LANE = 20;
const LANE_GAP = 4;

function lanesChart(figure) {
  const count = data.lanes.length;
  const columns = [[0, data.duration], [0, count]];
  timeChart(figure, {
    columns,
    padding: [0, 12, 0, 0],
    series: [{ show: false }],
    y: { dir: -1, range: () => [0, count] },
    axis: {
      ...axisLook(),
      size: Math.min(200, figure.clientWidth / 3),
      grid: { show: false },
      stroke: () => colour("--ink"),
      splits: () => data.lanes.map((_, index) => index + 0.5),
      values: () => data.lanes.map(({ name }) => shortened(name)),
    },
    points: { show: false },
    hooks: { draw: [(chart) => data.lanes.forEach((lane, index) => drawLane(chart, lane, index))] },
  });
}

function shortened(name) {
  return name.length <= 30 ? name : `…${name.slice(-29)}`;
}

function drawLane(chart, lane, index) {
  const { ctx, bbox } = chart;
  const unit = devicePixelRatio;
  const top = chart.valToPos(index, "y", true);
  const height = ((chart.valToPos(index + 1, "y", true) - top) * LANE) / (LANE + LANE_GAP);
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.font = FONT.replace("11px", `${11 * unit}px`);
  ctx.textBaseline = "middle";
  ctx.textAlign = "left";
  for (const [start, end, text, look] of lane.spans) {
    const left = Math.max(chart.valToPos(start, "x", true), bbox.left);
    const right = Math.min(chart.valToPos(end, "x", true), bbox.left + bbox.width);
    if (right <= left) continue;
    ctx.fillStyle = faded(ruleColour(look), look === "by-default" ? 0.22 : 0.42);
    ctx.fillRect(left, top, right - left, height);
    ctx.fillStyle = ruleColour(look);
    ctx.fillRect(left, top, 2 * unit, height);
    ctx.fillStyle = colour("--ink");
    if (ctx.measureText(text).width + 12 * unit < right - left) ctx.fillText(text, left + 7 * unit, top + height / 2);
  }
  ctx.restore();
}
