// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, signal } from "@preact/signals";
import { useEffect, useMemo } from "preact/hooks";
import { type Api, refusal } from "../api/client";
import type { IncidentAnswer } from "../api/types";
import type { MapPicture, MapZone } from "../map/shapes";
import { layoutName, PLAIN_GRID, readLayout } from "../state/layout";
import { MapFloor } from "../state/map_floor";
import { zonesAt } from "../try/try_result";

/** What a path is drawn on. */
export interface Ground {
  picture: Signal<MapPicture | null>;
  zones: Signal<readonly MapZone[]>;
}

/** The map of the rule file that recorded an incident, and its zones if it holds the same text as then. */
export function useRuleGround(api: Api, incident: IncidentAnswer): Ground {
  const { rule_file, is_same_text, record } = incident;
  const zones = useMemo(() => signal<readonly MapZone[]>([]), []);
  // Without it there is a plain grid, and the rest of the page is as it was.
  const owner = useMemo(() => ({ map: signal(PLAIN_GRID), tell: () => {} }), []);
  const floor = useMemo(() => new MapFloor(api, owner), []);
  useEffect(() => floor.followPicture(), []);
  useEffect(() => {
    if (rule_file === null) return;
    const load = async () => {
      const { files } = await api.project();
      if (files.some(({ name }) => name === layoutName(rule_file))) {
        owner.map.value = (await readLayout(api, rule_file)).map;
      }
      if (!is_same_text) return;
      const { text } = await api.read(rule_file);
      const { rules } = await api.ask("POST /api/zones", { text, name: rule_file, profile_text: null });
      zones.value = zonesAt(rules, [record.rule]);
    };
    load().catch((error: unknown) => {
      refusal(error);
    });
  }, [rule_file]);
  return { picture: floor.picture, zones };
}
