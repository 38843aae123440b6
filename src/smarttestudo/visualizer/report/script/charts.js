// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// The rate of each topic, the bandwidth of all, and what that consists of.

function rateChart(figure, topic) {
  const targets = topic.targets;
  const steps = [targets.map(([start]) => start), targets.map(([, , rate]) => rate)];
  if (targets.length) {
    steps[0].push(targets[targets.length - 1][1]);
    steps[1].push(targets[targets.length - 1][2]);
  }
  const target = {
    stroke: () => faded(colour("--ink"), 0.2),
    width: 6,
    paths: uPlot.paths.stepped({ align: 1 }),
    points: { show: false },
  };
  timeChart(figure, {
    columns: uPlot.join([courseColumns(topic.before), courseColumns(topic.after), steps]),
    series: [
      ...courseSeries(topic.before, () => colour("--before"), 1.25),
      ...courseSeries(topic.after, () => colour("--ink"), 1.5),
      target,
    ],
    y: rateScale(topic),
    axis: { ...valueAxis(34), splits: () => topic.ticks },
    unit: "Hz",
    hooks: { drawClear: [(chart) => shade(chart, topic.name)], draw: [(chart) => markGap(chart, topic)] },
  });
  figureReadout(figure, () => `${number(valueAt(topic.before, time.now))}${arrow(topic.after)} Hz`);
}

// A scale in as many straight pieces as the static drawing has: it may leave a gap out.
function rateScale({ values, places }) {
  if (values.length === 2) return { range: () => [values[0], values[1]] };
  const between = (from, to) => (value) => {
    const index = clamp(lastIndex(from, value), 0, from.length - 2);
    const share = (value - from[index]) / (from[index + 1] - from[index]);
    return to[index] + share * (to[index + 1] - to[index]);
  };
  const range = () => [values[0], values[values.length - 1]];
  return { distr: 100, fwd: between(values, places), bwd: between(places, values), range };
}

function shade(chart, topic) {
  const lane = data.lanes.find(({ name }) => name === topic);
  const { ctx, bbox } = chart;
  for (const [start, end, , look] of lane ? lane.spans : []) {
    const left = Math.max(chart.valToPos(start, "x", true), bbox.left);
    const right = Math.min(chart.valToPos(end, "x", true), bbox.left + bbox.width);
    if (right <= left) continue;
    const isDefault = look === "by-default";
    ctx.fillStyle = faded(ruleColour(look), isDefault ? 0 : 0.1);
    ctx.fillRect(left, bbox.top, right - left, bbox.height);
    ctx.fillStyle = faded(ruleColour(look), isDefault ? 0.4 : 1);
    ctx.fillRect(left, bbox.top + bbox.height + 2, right - left, 4 * devicePixelRatio);
  }
}

function markGap(chart, { values }) {
  if (values.length === 2) return;
  const { ctx, bbox } = chart;
  const middle = (chart.valToPos(values[1], "y", true) + chart.valToPos(values[2], "y", true)) / 2;
  const unit = devicePixelRatio;
  ctx.strokeStyle = colour("--quiet");
  ctx.lineWidth = 1.25 * unit;
  for (const at of [middle - 2 * unit, middle + 2 * unit]) {
    ctx.beginPath();
    ctx.moveTo(bbox.left - 5 * unit, at + 2 * unit);
    ctx.lineTo(bbox.left + 5 * unit, at - 2 * unit);
    ctx.stroke();
  }
}

function totalChart(figure) {
  const { before, after, top } = data.total;
  timeChart(figure, {
    columns: uPlot.join([courseColumns(before), courseColumns(after)]),
    series: [
      ...courseSeries(before, () => colour("--before"), 1.5),
      ...courseSeries(after, () => colour("--ink"), 1.75),
    ],
    y: { range: () => [0, top] },
    axis: valueAxis(60),
    unit: "KB/s",
    hooks: { draw: [drawBudget] },
  });
  figureReadout(figure, () => `${number(valueAt(before, time.now))}${arrow(after)} KB/s`);
}

function stackedChart(figure) {
  const { layers, top } = data.stack;
  if (!layers.length) return;
  const sums = layers.map((_, index) =>
    layers[0].high.map((_, at) => layers.slice(0, index + 1).reduce((sum, layer) => sum + layer.high[at], 0)),
  );
  // The highest first: each covers the foot of the one before.
  const order = layers.map((_, index) => index).reverse();
  timeChart(figure, {
    columns: [timesOf(layers[0]), ...order.map((index) => sums[index])],
    series: order.map((index) => ({
      stroke: () => colour("--paper"),
      fill: () => colour(`--share-${index + 1}`),
      width: 1,
      points: { show: false },
    })),
    y: { range: () => [0, top] },
    axis: valueAxis(60),
    unit: "KB/s",
    hooks: { draw: [drawBudget] },
    points: { show: false },
  });
  figureReadout(figure, () => {
    const largest = layers.slice(0, 3).map((layer) => `${layer.name} ${number(valueAt(layer, time.now))}`);
    return `${largest.join(", ")} KB/s`;
  });
}

function drawBudget(chart) {
  if (data.budget === null) return;
  const { ctx, bbox } = chart;
  const at = Math.max(chart.valToPos(data.budget, "y", true), bbox.top);
  ctx.save();
  ctx.strokeStyle = colour("--ink");
  ctx.lineWidth = 1.5 * devicePixelRatio;
  ctx.setLineDash([8 * devicePixelRatio, 5 * devicePixelRatio]);
  ctx.beginPath();
  ctx.moveTo(bbox.left, at);
  ctx.lineTo(bbox.left + bbox.width, at);
  ctx.stroke();
  ctx.restore();
}

function arrow(after) {
  return data.isPair ? ` → ${number(valueAt(after, time.now))}` : "";
}

// What the figure's caption says about the time under the cursor; what it said before where there is none.
function figureReadout(figure, words) {
  const caption = figure.querySelector("figcaption");
  let readout = caption.querySelector(".readout");
  if (!readout) {
    readout = document.createElement("span");
    readout.className = "quiet readout";
    caption.append(readout);
  }
  const usual = readout.textContent;
  time.watch(() => {
    readout.textContent = time.now === null ? usual : words();
  });
}
