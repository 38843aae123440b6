// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";
import { MapCanvas } from "../map/map_canvas";
import type { MapView } from "../map/map_view";
import type { Point } from "../map/shapes";
import type { Trial } from "../state/trial";

/** Where the robot went and is at the time of the scrubber, with a dot wherever something was decided. */
export function TryMap({ trial }: { trial: Trial }) {
  const [view, setView] = useState<MapView | null>(null);
  const path = useMemo(() => trial.answer.path.map(([, x, y]): Point => [x, y]), [trial]);
  const dots = useMemo(
    () => trial.decisionTimes.flatMap((t): Point[] => [trial.placeAt(t)?.place ?? []].filter((each) => each.length === 2)),
    [trial],
  );
  useEffect(() => (view ? followRobot(view, trial) : undefined), [view, trial]);
  const at = trial.placeAt(trial.time.value)?.place;
  return (
    <figure class="try-map">
      <figcaption>
        <strong>Path</strong>{" "}
        <span class="quiet">
          in metres; dots are decisions. The robot is at{" "}
          {at ? `x ${at[0].toFixed(1)} m, y ${at[1].toFixed(1)} m` : "no known place"}.
        </span>
      </figcaption>
      <div class="try-map-host">
        <MapCanvas label="Path of the robot" path={path} dots={dots} opened={setView} />
      </div>
    </figure>
  );
}

function followRobot(view: MapView, trial: Trial): () => void {
  return effect(() => {
    const robot = trial.placeAt(trial.time.value);
    view.setRobot(robot?.place ?? null, robot?.heading_rad ?? null);
  });
}
