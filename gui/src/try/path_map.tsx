// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";
import { MapCanvas } from "../map/map_canvas";
import type { MapView } from "../map/map_view";
import type { MapPicture, MapZone, Point } from "../map/shapes";
import type { Timeline } from "../state/timeline";

interface PathMapProps {
  timeline: Timeline;
  path: readonly (readonly [number, number, number])[];
  /** Times at which the path has a dot, and what dots are. */
  dotsS: readonly number[];
  dotsAre: string;
  picture?: MapPicture | null;
  zones?: readonly MapZone[];
  isNear?: boolean;
  isLive?: boolean;
}

/** Where the robot of a recording went, and is at the time of the slider. */
export function PathMap({
  timeline,
  path,
  dotsS,
  dotsAre,
  picture = null,
  zones = NO_ZONES,
  isNear = false,
  isLive = false,
}: PathMapProps) {
  const [view, setView] = useState<MapView | null>(null);
  const points = useMemo(() => path.map(([, x, y]): Point => [x, y]), [path]);
  const dots = useMemo(
    () => dotsS.flatMap((t): Point[] => [timeline.placeAt(t)?.place ?? []].filter((each) => each.length === 2)),
    [timeline, dotsS],
  );
  useEffect(() => (view ? followRobot(view, timeline) : undefined), [view, timeline]);
  const at = timeline.placeAt(timeline.time.value)?.place;
  return (
    <figure class="try-map">
      <figcaption>
        <strong>Path</strong> <span class="quiet">{dotsAre}</span>{" "}
        <span class="robot-place">
          {at ? `The robot is at x ${at[0].toFixed(1)} m, y ${at[1].toFixed(1)} m` : "The robot's position is unknown"}
        </span>
      </figcaption>
      <div class="try-map-host">
        <MapCanvas
          label="Path of the robot"
          picture={picture}
          zones={zones}
          path={points}
          dots={dots}
          {...{ isNear, isLive }}
          opened={setView}
        />
      </div>
    </figure>
  );
}

const NO_ZONES: readonly MapZone[] = [];

function followRobot(view: MapView, timeline: Timeline): () => void {
  return effect(() => {
    const robot = timeline.placeAt(timeline.time.value);
    view.setRobot(robot?.place ?? null, robot?.heading_rad ?? null);
  });
}
