// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";
import { watchSize, watchTheme } from "../ui/watch";
import { type Chart, drawCurve } from "./curve_plot";
import { axisOf, type LevelKind } from "./level_axis";
import { LevelLines } from "./level_lines";

/** The six levels of a topic as lines that can be dragged, over a chart where there is one. */
export function LevelPlot(props: {
  /** The topic, with the property where the levels are accuracies. */
  of: string;
  kind: LevelKind;
  levels: readonly number[] | null;
  chart: Chart | null;
  axisLabel: string;
  move: (index: number, value: number, goesOn: boolean) => void;
}) {
  const { kind, levels, chart, axisLabel, move } = props;
  const host = useRef<HTMLDivElement>(null);
  const [area, setArea] = useState({ left: 0, width: 0 });
  const [isDragging, setDragging] = useState(false);
  const wanted = axisOf([...(chart?.at ?? []), ...(levels ?? [])]);
  // While a line is dragged the axis under it must stand still.
  const axis = useRef(wanted);
  if (!isDragging) axis.current = wanted;
  const { low, high } = axis.current;
  useEffect(() => {
    const element = host.current;
    if (!element) return;
    const draw = () => drawCurve(element, chart, { low, high }, axisLabel, setArea);
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
  }, [chart, axisLabel, low, high]);
  return (
    <div class="level-plot">
      <div ref={host} class="level-host" aria-hidden="true" />
      {levels && (
        <div class="level-area" style={{ left: `${area.left}px`, width: `${area.width}px` }}>
          <LevelLines of={props.of} {...{ kind, levels, move }} axis={axis.current} dragging={setDragging} />
        </div>
      )}
    </div>
  );
}
