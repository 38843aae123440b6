// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// What all charts share: the time under the cursor, and the stretch of time that they show.

const data = JSON.parse(document.getElementById("chart-data").textContent);

const time = {
  now: null,
  from: 0,
  to: data.duration,
  watchers: [],

  watch(watcher) {
    this.watchers.push(watcher);
  },

  moveTo(seconds) {
    const now = clamp(seconds, 0, data.duration);
    if (now === this.now) return;
    this.now = now;
    this.tell();
  },

  show(from, to) {
    const length = clamp(to - from, data.duration / 1000, data.duration);
    this.from = clamp(from, 0, data.duration - length);
    this.to = this.from + length;
    this.tell();
  },

  showAll() {
    this.show(0, data.duration);
  },

  // Stretches what is shown by `factor`, around the cursor or else its middle.
  zoom(factor) {
    const middle = this.isShown() ? this.now : (this.from + this.to) / 2;
    this.show(middle - (middle - this.from) * factor, middle + (this.to - middle) * factor);
  },

  isShown() {
    return this.now !== null && this.from <= this.now && this.now <= this.to;
  },

  isWhole() {
    return this.from === 0 && this.to === data.duration;
  },

  tell() {
    this.watchers.forEach((watcher) => watcher());
  },
};

function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

// The index of the last of the rising `times` that is at most `seconds`; -1 where none is.
function lastIndex(times, seconds) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= seconds) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

// The value of a course at the point nearest to `seconds`; null where it has none.
function valueAt({ times, values }, seconds) {
  if (!times.length) return null;
  const index = clamp(lastIndex(times, seconds), 0, times.length - 1);
  const isNextNearer = index + 1 < times.length && times[index + 1] - seconds < seconds - times[index];
  return values[isNextNearer ? index + 1 : index];
}

function number(value) {
  if (value === null) return "–";
  const digits = Math.abs(value) >= 100 ? 0 : Math.abs(value) >= 10 ? 1 : 2;
  return value.toLocaleString("en-US", { maximumFractionDigits: digits }).replaceAll(",", " ");
}

function seconds(value) {
  return `${value.toFixed(time.to - time.from < 20 ? 2 : 1)} s`;
}

// A drawing over time that follows the cursor and the zoom of all others.

const PIXELS_PER_TIME = 55;
const MOST_TIMES = 10;
const TOLERANCE = 0.005;
const LEAST_DRAG = 4;

function timeChart(drawing) {
  const plots = [...drawing.querySelectorAll(".plot")].map((plot) => plot.viewBox.baseVal);
  const ground = drawing.querySelector(".ground");
  const times = drawing.querySelector(".times");
  const chosen = shape("rect", { class: "chosen" });
  const cursor = shape("line", { class: "cursor" });
  drawing.append(chosen, cursor);

  time.watch(() => {
    if (plots[0].x !== time.from || plots[0].width !== time.to - time.from) {
      for (const plot of plots) {
        plot.x = time.from;
        plot.width = time.to - time.from;
      }
      writeTimes(times, ground);
    }
    cursor.classList.toggle("known", time.isShown());
    ["x1", "x2"].forEach((name) => cursor.setAttribute(name, place(time.now ?? 0)));
  });
  new ResizeObserver(() => {
    const { y, height } = ground.getBBox();
    setAll(chosen, { y, height });
    setAll(cursor, { y1: y, y2: y + height });
    writeTimes(times, ground);
  }).observe(drawing);

  const timeAt = (event) => {
    const { left, width } = ground.getBoundingClientRect();
    return time.from + clamp((event.clientX - left) / width, 0, 1) * (time.to - time.from);
  };
  let pressed = null;
  drawing.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    event.preventDefault();
    drawing.setPointerCapture(event.pointerId);
    pressed = { time: timeAt(event), x: event.clientX };
  });
  drawing.addEventListener("pointermove", (event) => {
    time.moveTo(timeAt(event));
    if (pressed) mark(chosen, pressed.time, timeAt(event));
  });
  drawing.addEventListener("pointerup", (event) => {
    const from = pressed;
    end();
    if (from === null || Math.abs(event.clientX - from.x) < LEAST_DRAG) return;
    const ends = [from.time, timeAt(event)].sort((one, other) => one - other);
    time.show(...ends);
  });
  const end = () => {
    pressed = null;
    mark(chosen, 0, 0);
  };
  drawing.addEventListener("pointercancel", end);
  drawing.addEventListener("dblclick", () => time.showAll());
}

function mark(chosen, one, other) {
  chosen.setAttribute("x", place(Math.min(one, other)));
  chosen.setAttribute("width", `${(100 * Math.abs(other - one)) / (time.to - time.from)}%`);
}

// Where a time is in a drawing, whatever its width.
function place(seconds) {
  return `${(100 * (seconds - time.from)) / (time.to - time.from)}%`;
}

function writeTimes(times, ground) {
  const most = clamp(ground.getBoundingClientRect().width / PIXELS_PER_TIME, 1, MOST_TIMES);
  const wanted = (time.to - time.from) / most;
  const power = 10 ** Math.floor(Math.log10(wanted));
  const step = power * [1, 2, 5, 10].find((each) => each * power >= wanted * (1 - 1e-9));
  // The end of a run that is a little short of a round time has a label too.
  const last = time.to + TOLERANCE * (time.to - time.from);
  const marks = [];
  for (let at = Math.ceil(time.from / step - 1e-9); at * step <= last; at++) marks.push(at * step);
  times.replaceChildren(
    ...marks.map((at, index) => {
      const label = shape("text", { x: place(at), "text-anchor": "middle" });
      label.textContent = Number(at.toPrecision(9)) + (index === marks.length - 1 ? " s" : "");
      return label;
    }),
  );
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

// Says the values of the recordings' lines at the time under the cursor.
function linesReadout(drawing) {
  const courses = [...drawing.querySelectorAll(".before, .after")].map((line) => courseOf(line, drawing));
  return () => `${courses.map((course) => number(valueAt(course, time.now))).join(" → ")} ${drawing.dataset.unit}`;
}

// The times and values of a line's points: of an area those of its upper edge, from which it goes back.
function courseOf(line, drawing) {
  const points = [...line.points];
  const turn = points.findIndex((point, index) => index > 0 && point.x <= points[index - 1].x);
  const edge = turn < 0 ? points : points.slice(0, turn);
  const [values, heights] = JSON.parse(drawing.dataset.heights ?? "[[], []]");
  return { times: edge.map(({ x }) => x), values: edge.map((point) => between(heights, values, point.y)) };
}

// The piecewise linear map from rising `from` to `to`; without these, `value` itself.
function between(from, to, value) {
  if (!from.length) return value;
  const index = clamp(lastIndex(from, value), 0, from.length - 2);
  return to[index] + ((value - from[index]) / (from[index + 1] - from[index])) * (to[index + 1] - to[index]);
}

function shape(name, attributes) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  setAll(made, attributes);
  return made;
}

function setAll(element, attributes) {
  Object.entries(attributes).forEach(([key, value]) => element.setAttribute(key, value));
}

// The bars of the rates that each topic was given, with as many of their texts as there is room for.

const CHARACTER_WIDTH = 6.4;

function lanesOf(drawing) {
  const names = [...drawing.querySelectorAll(".bar-name")];
  const bars = [...drawing.querySelectorAll(".bar")].map(({ x, width }, index) => ({
    start: x.baseVal.value,
    end: x.baseVal.value + width.baseVal.value,
    name: names[index],
    text: names[index].textContent,
  }));
  return { bars, leading: bars.slice(0, drawing.querySelector(".lane").querySelectorAll(".bar").length) };
}

function nameBars(drawing, bars) {
  const ground = drawing.querySelector(".ground");
  const write = () => {
    const width = ground.getBoundingClientRect().width;
    for (const { start, end, name, text } of bars) {
      const left = Math.max(start, time.from);
      const room = (width * (Math.min(end, time.to) - left)) / (time.to - time.from);
      name.setAttribute("display", CHARACTER_WIDTH * text.length + 8 < room ? "inline" : "none");
      name.setAttribute("x", place(left));
    }
  };
  let shown = "";
  time.watch(() => {
    if (shown !== (shown = `${time.from} ${time.to}`)) write();
  });
  new ResizeObserver(write).observe(drawing);
}

// Where the robot was at the time under the cursor, and in the stretch of time that is shown.

const REACH = 40;

function followOnMap(map) {
  const times = data.path.map(([t]) => t);
  const stretch = shape("polyline", { class: "shown-path" });
  const robot = shape("circle", { class: "robot", r: 8 });
  map.append(stretch, robot);

  time.watch(() => {
    const first = Math.max(lastIndex(times, time.from), 0);
    const last = lastIndex(times, time.to);
    const places = data.path.slice(first, last + 1);
    stretch.setAttribute("points", time.isWhole() ? "" : places.map(([, x, y]) => `${x},${y}`).join(" "));
    map.classList.toggle("zoomed", !time.isWhole());
    const place = time.now === null ? undefined : data.path[Math.max(lastIndex(times, time.now), 0)];
    robot.classList.toggle("known", place !== undefined);
    if (place) {
      robot.setAttribute("cx", place[1]);
      robot.setAttribute("cy", place[2]);
    }
  });
  map.addEventListener("pointermove", (event) => {
    const place = nearest(new DOMPoint(event.clientX, event.clientY).matrixTransform(map.getScreenCTM().inverse()));
    if (place) time.moveTo(place[0]);
  });
}

// The place on the path nearest to `point`, if one is near.
function nearest(point) {
  let best;
  let least = REACH * REACH;
  for (const place of data.path) {
    const distance = (place[1] - point.x) ** 2 + (place[2] - point.y) ** 2;
    if (distance < least) {
      least = distance;
      best = place;
    }
  }
  return best;
}

// The time by keyboard: the bar at the foot of the window, what holds then and the zoom, and decisions.

// `told` has the bars of the rule that decided most topics, and what says all topics' bandwidth.
function timeBar(told) {
  const bar = document.createElement("form");
  bar.className = "time-bar";
  bar.setAttribute("aria-label", "Time");
  const slider = document.createElement("input");
  Object.assign(slider, { type: "range", min: 0, max: data.duration, step: data.duration / 1000 || 1, value: 0 });
  slider.setAttribute("aria-label", "Time in the recording, in seconds");
  const words = document.createElement("output");
  const whole = button("Whole run", () => time.showAll());
  bar.append(
    slider,
    words,
    button("−", () => time.zoom(2), "Zoom out"),
    button("+", () => time.zoom(0.5), "Zoom in"),
    whole,
  );
  slider.addEventListener("input", () => time.moveTo(slider.valueAsNumber));
  bar.addEventListener("submit", (event) => event.preventDefault());
  time.watch(() => {
    if (time.now !== null) slider.value = time.now;
    slider.setAttribute("aria-valuetext", words.textContent = sentence(told));
    bar.classList.toggle("idle", time.now === null);
    whole.disabled = time.isWhole();
  });
  document.body.append(bar);
}

function sentence({ leading, total }) {
  if (time.now === null) return "Point at a chart or the map; drag across a chart to zoom.";
  const parts = [seconds(time.now)];
  const bar = leading.find(({ start, end }) => start <= time.now && time.now < end);
  if (bar) parts.push(bar.text);
  if (total) parts.push(total());
  return parts.join(" · ");
}

function button(text, act, label = text) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.setAttribute("aria-label", label);
  made.addEventListener("click", act);
  return made;
}

// Decisions move the cursor to their time.
function movesCursor(row) {
  const cell = row.cells[0];
  const handle = button(cell.textContent, () => time.moveTo(Number(row.dataset.time)), `Show ${cell.textContent} s`);
  cell.replaceChildren(handle);
}

// Puts everything in place; what is drawn is there already.

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
  const words = linesReadout(drawing);
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
