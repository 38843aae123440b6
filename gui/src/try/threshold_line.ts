// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal } from "@preact/signals";
import type uPlot from "uplot";
import { readable } from "../ui/numbers";

const STEPS: Readonly<Record<string, number>> = { ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10 };

/** A number of so many digits as a range of values needs: one 200th of it can be told. */
export function rounded(value: number, range: number): number {
  const step = stepOf(range);
  return Number((Math.round(value / step) * step).toPrecision(12));
}

function stepOf(range: number): number {
  return range > 0 ? 10 ** Math.floor(Math.log10(range / 50)) : 1;
}

/** A line at `value` until the returned function is called; unless it `isFixed`, it is dragged, and moved with the arrow keys. */
export function drawThreshold(plot: uPlot, value: Signal<number>, isFixed: boolean): () => void {
  const line = document.createElement("div");
  line.className = isFixed ? "threshold-line fixed" : "threshold-line";
  plot.over.append(line);
  const ends = (): readonly [number, number] => {
    const { y } = plot.scales;
    return [y?.min ?? 0, y?.max ?? 1];
  };
  const move = (to: number) => {
    const [least, most] = ends();
    value.value = rounded(Math.min(Math.max(to, least), most), most - least);
  };
  const place = () => {
    const [least, most] = ends();
    line.style.top = `${plot.valToPos(Math.min(Math.max(value.value, least), most), "y")}px`;
    if (isFixed) return;
    line.setAttribute("aria-valuemin", String(rounded(least, most - least)));
    line.setAttribute("aria-valuemax", String(rounded(most, most - least)));
    line.setAttribute("aria-valuenow", String(value.value));
    line.setAttribute("aria-valuetext", readable(value.value));
  };
  plot.hooks.draw = [...(plot.hooks.draw ?? []), place];
  if (isFixed) return effect(place);
  line.tabIndex = 0;
  line.setAttribute("role", "slider");
  line.setAttribute("aria-label", "Threshold");
  line.setAttribute("aria-orientation", "vertical");
  line.addEventListener("pointerdown", (event) => {
    event.stopPropagation();
    line.setPointerCapture(event.pointerId);
  });
  line.addEventListener("pointermove", (event) => {
    event.stopPropagation();
    if (event.buttons !== 1 || !line.hasPointerCapture(event.pointerId)) return;
    move(plot.posToVal(event.clientY - plot.over.getBoundingClientRect().top, "y"));
  });
  line.addEventListener("keydown", (event) => {
    const steps = STEPS[event.key];
    if (steps === undefined) return;
    event.preventDefault();
    const [least, most] = ends();
    move(value.peek() + steps * stepOf(most - least));
  });
  return effect(place);
}
