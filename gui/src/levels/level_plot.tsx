// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";
import type { Curve } from "../api/types";
import { watchSize, watchTheme } from "../ui/watch";
import { drawCurve } from "./curve_plot";
import { LevelLines } from "./level_lines";
import { axisOf } from "./rate_axis";

/** The six levels of a topic as lines that can be dragged, over what each rate loses where that is known. */
export function LevelPlot(props: {
  topic: string;
  levels_hz: readonly number[] | null;
  curve: Curve | null;
  move: (index: number, rate_hz: number, goesOn: boolean) => void;
}) {
  const { topic, levels_hz, curve, move } = props;
  const host = useRef<HTMLDivElement>(null);
  const [area, setArea] = useState({ left: 0, width: 0 });
  const [isDragging, setDragging] = useState(false);
  const points = curve?.points ?? [];
  const wanted = axisOf([...points.map((point) => point.rate_hz), ...(levels_hz ?? [])]);
  // While a line is dragged the axis under it must stand still.
  const axis = useRef(wanted);
  if (!isDragging) axis.current = wanted;
  const { low_hz, high_hz } = axis.current;
  useEffect(() => {
    const element = host.current;
    if (!element) return;
    const draw = () => drawCurve(element, points, { low_hz, high_hz }, setArea);
    let plot = draw();
    const again = () => {
      plot.destroy();
      plot = draw();
    };
    const stops = [watchSize(element, again), watchTheme(again)];
    return () => {
      for (const stop of stops) stop();
      plot.destroy();
    };
  }, [curve, low_hz, high_hz]);
  return (
    <div class="level-plot">
      <div ref={host} class="level-host" aria-hidden="true" />
      {levels_hz && (
        <div class="level-area" style={{ left: `${area.left}px`, width: `${area.width}px` }}>
          <LevelLines {...{ topic, levels_hz, move }} axis={axis.current} dragging={setDragging} />
        </div>
      )}
    </div>
  );
}
