// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo } from "preact/hooks";
import type { Api } from "../api/client";
import type { RuleZones } from "../api/types";
import type { MapZone } from "../map/shapes";
import { MapFloor } from "../state/map_floor";
import type { RuleEditor } from "../state/rule_editor";
import type { Trial } from "../state/trial";
import { ZoneEditor } from "../state/zone_editor";
import { PathMap } from "./path_map";

/** Where the robot went and is at the time of the scrubber, with a dot wherever something was decided. */
export function TryMap({ editor, api, trial }: { editor: RuleEditor; api: Api; trial: Trial }) {
  const zones = useMemo(() => new ZoneEditor(api, editor), []);
  const floor = useMemo(() => new MapFloor(api, editor), []);
  useEffect(() => zones.follow(), []);
  useEffect(() => floor.followPicture(), []);
  const deciding = trial.rules.value.filter(({ decides }) => decides.length > 0).map(({ rule }) => rule);
  const shown = useMemo(() => zonesAt(zones.rules.value, deciding), [zones.rules.value, deciding.join("\n")]);
  return (
    <PathMap
      timeline={trial}
      path={trial.answer.path}
      dotsS={trial.decisionTimes}
      dotsAre="Dots are decisions."
      picture={floor.picture.value}
      zones={shown}
    />
  );
}

/** The zones of the rules; those of the rules in `deciding` are in another colour. */
export function zonesAt(rules: readonly RuleZones[], deciding: readonly string[]): MapZone[] {
  return rules
    .filter((rule) => rule.zones.length > 0)
    .map(({ id, label, zones }) => ({
      id,
      label,
      rectangles: zones.map((zone) => zone.rectangle),
      tone: deciding.includes(label) ? "selected" : "zone",
    }));
}
