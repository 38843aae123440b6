// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

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
