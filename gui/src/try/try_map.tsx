// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { RuleZones } from "../api/types";
import { MapCanvas } from "../map/map_canvas";
import type { MapView } from "../map/map_view";
import type { MapZone, Point } from "../map/shapes";
import { MapFloor } from "../state/map_floor";
import type { RuleEditor } from "../state/rule_editor";
import type { Trial } from "../state/trial";
import { ZoneEditor } from "../state/zone_editor";

/** Where the robot went and is at the time of the scrubber, with a dot wherever something was decided. */
export function TryMap({ editor, api, trial }: { editor: RuleEditor; api: Api; trial: Trial }) {
  const zones = useMemo(() => new ZoneEditor(api, editor), []);
  const floor = useMemo(() => new MapFloor(api, editor), []);
  useEffect(() => zones.follow(), []);
  useEffect(() => floor.followPicture(), []);
  const [view, setView] = useState<MapView | null>(null);
  const path = useMemo(() => trial.answer.path.map(([, x, y]): Point => [x, y]), [trial]);
  const dots = useMemo(
    () =>
      trial.decisionTimes.flatMap((t): Point[] => [trial.placeAt(t)?.place ?? []].filter((each) => each.length === 2)),
    [trial],
  );
  const deciding = trial.rules.value.filter(({ decides }) => decides.length > 0).map(({ rule }) => rule);
  const shown = useMemo(() => zonesAt(zones.rules.value, deciding), [zones.rules.value, deciding.join("\n")]);
  useEffect(() => (view ? followRobot(view, trial) : undefined), [view, trial]);
  const at = trial.placeAt(trial.time.value)?.place;
  return (
    <figure class="try-map">
      <figcaption>
        <strong>Path</strong> <span class="quiet">Dots are decisions.</span>{" "}
        <span class="robot-place">
          {at ? `The robot is at x ${at[0].toFixed(1)} m, y ${at[1].toFixed(1)} m` : "The robot's position is unknown"}
        </span>
      </figcaption>
      <div class="try-map-host">
        <MapCanvas
          label="Path of the robot"
          picture={floor.picture.value}
          zones={shown}
          path={path}
          dots={dots}
          opened={setView}
        />
      </div>
    </figure>
  );
}

/** The zones of the rules; those of the rules in `deciding` are in another colour. */
function zonesAt(rules: readonly RuleZones[], deciding: readonly string[]): MapZone[] {
  return rules
    .filter((rule) => rule.zones.length > 0)
    .map(({ id, label, zones }) => ({
      id,
      label,
      rectangles: zones.map((zone) => zone.rectangle),
      tone: deciding.includes(label) ? "selected" : "zone",
    }));
}

function followRobot(view: MapView, trial: Trial): () => void {
  return effect(() => {
    const robot = trial.placeAt(trial.time.value);
    view.setRobot(robot?.place ?? null, robot?.heading_rad ?? null);
  });
}
