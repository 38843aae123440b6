// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

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
