// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { RuleZones, ZoneBounds } from "../api/types";
import type { ZoneEditor } from "../state/zone_editor";

/** Every zone in words, with what else its rule asks for, and which zones clash. */
export function ZoneList({ zones }: { zones: ZoneEditor }) {
  const { rules, chosen, answer } = zones;
  const placed = rules.value.filter((rule) => rule.zones.length > 0);
  const mixed = rules.value.filter((rule) => rule.is_too_mixed);
  const others = rules.value.length - placed.length - mixed.length;
  return (
    <div class="zone-list">
      {answer.value?.zones.clashes.map((clash) => (
        <p key={`${clash.first} ${clash.second} ${clash.message}`} class="problem">
          Clash: {clash.message}. <span class="quiet">{clash.hint}</span>
        </p>
      ))}
      <ul aria-label="Zones">
        {placed.map((rule) => (
          <li key={rule.id}>
            <button
              type="button"
              class="small"
              aria-pressed={rule === chosen.value}
              onClick={() => zones.choose(rule.id)}
            >
              {rule.label}
            </button>
            <span class="quiet">{saidOf(rule)}</span>
          </li>
        ))}
      </ul>
      {answer.value && placed.length === 0 && (
        <p class="quiet">No rule depends on the position. Draw a zone, or type one.</p>
      )}
      {placed.length > 0 && others > 0 && (
        <p class="quiet">{others === 1 ? "1 rule does" : `${others} rules do`} not depend on the position.</p>
      )}
      {mixed.map((rule) => (
        <p key={rule.id} class="quiet">
          {rule.label} has too many conditions on the position to be drawn; its checks are in the block.
        </p>
      ))}
    </div>
  );
}

function saidOf(rule: RuleZones): string {
  const topics = [...new Set(rule.zones.map((zone) => zone.topic))].join(", ");
  const [first] = rule.zones;
  const place = rule.zones.length === 1 && first ? sidesOf(first.rectangle) : `${rule.zones.length} rectangles`;
  const others = rule.others.length > 0 ? `, if also ${rule.others.join(" and ")}` : "";
  return `${topics}: ${place}${rule.holds_elsewhere ? "" : others}${rule.holds_elsewhere ? "; it can hold elsewhere too" : ""}`;
}

function sidesOf({ min_x, max_x, min_y, max_y }: ZoneBounds): string {
  const axis = (name: string, from: number | null, to: number | null) => {
    if (from === null && to === null) return `any ${name}`;
    if (from === null) return `${name} below ${to} m`;
    return to === null ? `${name} above ${from} m` : `${name} ${from} … ${to} m`;
  };
  return `${axis("x", min_x, max_x)}, ${axis("y", min_y, max_y)}`;
}
