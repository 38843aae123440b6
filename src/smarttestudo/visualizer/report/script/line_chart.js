// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// A chart over time in place of a figure's static drawing; its cursor and zoom are those of all others.

// `plot` has `columns`, the first of them times, and uPlot's `series`, `y` scale, `axis` and `hooks`.
function timeChart(figure, plot) {
  const drawing = figure.querySelector("svg.static");
  const { width, height } = drawing.getBoundingClientRect();
  const host = document.createElement("div");
  host.className = "live";
  host.setAttribute("role", "img");
  host.setAttribute("aria-label", drawing.getAttribute("aria-label"));
  figure.append(host);

  let isFollowing = false;
  const chart = new uPlot(
    {
      width,
      height,
      padding: plot.padding ?? [18, 10, 0, 0],
      legend: { show: false },
      cursor: cursorOptions(plot),
      scales: { x: { time: false, range: () => [time.from, time.to] }, y: plot.y },
      axes: [timeAxis(), plot.axis],
      series: [{}, ...plot.series],
      hooks: {
        ...plot.hooks,
        drawAxes: [(self) => plot.unit && writeUnit(self, plot.unit)],
        setCursor: [(self) => !isFollowing && self.cursor.left >= 0 && time.moveTo(self.posToVal(self.cursor.left, "x"))],
        setSelect: [(self) => zoomToSelection(self)],
      },
    },
    plot.columns,
    host,
  );

  let shown = "";
  const follow = () => {
    isFollowing = true;
    if (shown !== `${time.from} ${time.to}`) {
      shown = `${time.from} ${time.to}`;
      chart.setScale("x", { min: time.from, max: time.to });
    }
    const left = time.isShown() ? chart.valToPos(time.now, "x") : -10;
    chart.setCursor({ left, top: left < 0 ? -10 : 1 });
    isFollowing = false;
  };
  time.watch(follow);
  darkness.addEventListener("change", () => chart.redraw());
  new ResizeObserver(() => fit(chart, figure, height / width)).observe(figure);
  return chart;
}

function cursorOptions(plot) {
  return {
    y: false,
    points: plot.points ?? { size: 6 },
    drag: { x: true, y: false, setScale: false },
    bind: { dblclick: () => () => time.showAll() },
  };
}

function zoomToSelection(chart) {
  const { left, width } = chart.select;
  if (width < 4) return;
  const from = chart.posToVal(left, "x");
  const to = chart.posToVal(left + width, "x");
  chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  time.show(from, to);
}

function fit(chart, figure, ratio) {
  const width = figure.clientWidth;
  if (width > 0 && width !== chart.width) chart.setSize({ width, height: Math.round(width * ratio) });
}

function timeAxis() {
  return {
    ...axisLook(),
    grid: { show: false },
    size: 30,
    gap: 8,
    values: (_, splits) => splits.map((split, index) => (index === splits.length - 1 ? `${split} s` : `${split}`)),
  };
}

function valueAxis(size) {
  return { ...axisLook(), size, filter: (_, splits) => splits, values: (_, splits) => splits.map((split) => split.toLocaleString("en-US")) };
}

function axisLook() {
  return {
    stroke: () => colour("--quiet"),
    grid: { stroke: () => colour("--faint"), width: 1 },
    ticks: { show: false },
    font: FONT,
    gap: 4,
  };
}

// Over the labels of the values.
function writeUnit(chart, unit) {
  const { ctx, bbox } = chart;
  ctx.save();
  ctx.fillStyle = colour("--quiet");
  ctx.font = FONT.replace("11px", `${11 * devicePixelRatio}px`);
  ctx.textAlign = "right";
  ctx.fillText(unit, bbox.left - 4 * devicePixelRatio, 11 * devicePixelRatio);
  ctx.restore();
}

// One line for a course, or two with the area between them where its points stand for several seconds.
function courseSeries(course, stroke, width) {
  const line = { stroke, width, points: { show: false } };
  return course.low ? [line, { ...line }] : [line];
}

function courseColumns(course) {
  const columns = [timesOf(course), course.high];
  return course.low ? [...columns, course.low] : columns;
}
