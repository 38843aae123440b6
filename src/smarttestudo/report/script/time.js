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
