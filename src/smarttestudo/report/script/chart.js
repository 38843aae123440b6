// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

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

// Says the largest layers' shares at the time under the cursor.
function layersReadout(drawing) {
  const lines = [...drawing.querySelectorAll(".layer")].reverse().slice(0, 3);
  const tops = lines.map((line) => courseOf(line, drawing));
  return () => {
    const heights = tops.map((top) => valueAt(top, time.now));
    const shares = lines.map((line, index) => `${line.dataset.name} ${number(heights[index] - (heights[index - 1] ?? 0))}`);
    return `${shares.join(", ")} ${drawing.dataset.unit}`;
  };
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
