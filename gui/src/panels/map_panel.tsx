// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { BackgroundChoice, RuleZones } from "../api/types";
import { MapCanvas } from "../map/map_canvas";
import type { MapView } from "../map/map_view";
import { bounded, type MapOwner, sidesWords, type Tool } from "../map/shapes";
import { MAP_FRAME, type MapFloor } from "../state/map_floor";
import type { RuleEditor } from "../state/rule_editor";
import { DRAFT, type ZoneEditor } from "../state/zone_editor";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";
import { NeedsServer } from "../ui/connection";
import { Notes, Notice, Problem } from "../ui/notice";
import { numberProblem, sentence, typedNumber } from "../ui/numbers";
import { showOnNarrow } from "../ui/watch";
import { ChosenZoneForm, DraftForm } from "./zone_forms";

const TOOLS: { tool: Exclude<Tool, "choose">; label: string }[] = [
  { tool: "rectangle", label: "Draw a rectangle" },
  { tool: "polygon", label: "Draw a polygon" },
];
const USUAL_TOPIC = "/odom";

/** The zones of the rules on a map: everything the mouse does there, the forms below it do as well. */
export function MapPanel({ editor, zones, floor }: { editor: RuleEditor; zones: ZoneEditor; floor: MapFloor }) {
  const tool = useSignal<Tool>("choose");
  const view = useRef<MapView | null>(null);
  const panel = useRef<HTMLElement>(null);
  useEffect(() => zones.follow(), []);
  useEffect(() => view.current?.setTool(tool.value), [tool.value, view.current]);
  useSignalEffect(() => {
    if (zones.redrawn.value) {
      tool.value = "rectangle";
      showOnNarrow(() => panel.current);
      // From the blocks, where Escape and the numbers of the zone would be far.
      requestAnimationFrame(() => panel.current?.querySelector<HTMLElement>(".map-tools button")?.focus());
    } else if (zones.draft.value === null) tool.value = "choose";
  });
  useEffect(() => {
    editor.takeBack = () => view.current?.removeLastCorner() || zones.discard();
    return () => (editor.takeBack = null);
  }, []);
  const leaveTool = () => {
    tool.value = "choose";
    zones.putAway();
  };
  useEffect(() => leaveTool, []);
  const owner = useMemo(() => ownerOf(zones, leaveTool), []);
  return (
    <section
      class="map-panel"
      aria-label="Map"
      ref={panel}
      onKeyDown={(event) => {
        if (event.key === "Escape") leaveTool();
      }}
    >
      <FloorNotes floor={floor} editor={editor} topics={zones.topics.value} />
      <div class="map-area">
        <MapCanvas
          label="Zones on the map"
          picture={floor.picture.value}
          path={floor.path.value}
          zones={zones.shown.value}
          owner={owner}
          opened={(opened) => {
            view.current = opened;
            opened?.setTool(tool.value);
          }}
        />
        <NeedsServer>
          <Tools {...{ zones, tool, leaveTool }} />
        </NeedsServer>
      </div>
      <div class="map-strip" key={zones.draft.value ? DRAFT : "chosen"}>
        <NeedsServer>
          {zones.draft.value ? (
            <DraftForm zones={zones} topic={floor.poseInMap.value ?? zones.topics.value[0] ?? USUAL_TOPIC} />
          ) : (
            <ChosenZoneForm zones={zones} />
          )}
        </NeedsServer>
        <ZoneList zones={zones} />
      </div>
    </section>
  );
}

interface ToolsProps {
  zones: ZoneEditor;
  tool: Signal<Tool>;
  leaveTool: () => void;
}

/** What the mouse does on the map; the form below it takes the same as numbers. */
function Tools({ zones, tool, leaveTool }: ToolsProps) {
  const isBroken = zones.editor.isBroken.value;
  const hint = hintOf(tool.value, isBroken);
  return (
    <div class="map-tools" role="toolbar" aria-label="Zones">
      {TOOLS.map((each) => (
        <Button
          label={each.label}
          key={each.tool}
          class="small"
          aria-pressed={tool.value === each.tool}
          disabled={isBroken}
          onClick={() => {
            if (tool.value === each.tool) return leaveTool();
            zones.redrawn.value = null;
            if (zones.draft.value?.shape !== each.tool)
              zones.draft.value = { shape: each.tool, rectangles: [], polygon: null };
            tool.value = each.tool;
          }}
        />
      ))}
      {hint && (
        <p class="map-hint" role="status">
          {hint}
        </p>
      )}
    </div>
  );
}

function hintOf(tool: Tool, isBroken: boolean): string {
  if (isBroken) return "The text has an error: mend it first.";
  if (tool === "rectangle") return "Press where one corner is, and pull to the other; or type the numbers below.";
  if (tool === "polygon")
    return "Press each corner, the last one twice; or type them below. Ctrl+Z takes a corner back.";
  return "";
}

function ownerOf(zones: ZoneEditor, done: () => void): MapOwner {
  return {
    chosen: (id, rectangle) => zones.choose(id, rectangle),
    moved: (id, by) => void zones.move(id, by),
    resized: (id, sides) => {
      const index = id === DRAFT ? 0 : zones.index.peek();
      const known = id === DRAFT ? zones.draft.peek()?.rectangles[0] : zones.chosen.peek()?.zones[index]?.rectangle;
      if (known) void zones.resize(id, index, bounded(known, sides));
    },
    drawn: (shape) => {
      void zones.draw(shape);
      done();
    },
    failed: () => (zones.editor.message.value = "The picture of the map cannot be shown"),
  };
}

/** Every zone in words, with what else its rule asks for, and which zones clash. */
function ZoneList({ zones }: { zones: ZoneEditor }) {
  const { rules, chosen, answer } = zones;
  const placed = rules.value.filter((rule) => rule.zones.length > 0);
  const mixed = rules.value.filter((rule) => rule.is_too_mixed);
  const others = rules.value.length - placed.length - mixed.length;
  return (
    <div class="zone-list">
      {answer.value?.zones.clashes.map((clash) => (
        <p key={`${clash.first} ${clash.second} ${clash.message}`} class="problem">
          Clash: {clash.message}. <span class="quiet">{sentence(clash.hint)}.</span>
        </p>
      ))}
      <ul aria-label="Zones">
        {placed.map((rule) => (
          <li key={rule.id}>
            <Button
              label={rule.label}
              class="small"
              aria-pressed={rule === chosen.value}
              onClick={() => zones.choose(rule.id)}
            />
            <span class="quiet">{saidOf(rule)}</span>
          </li>
        ))}
      </ul>
      {answer.value && placed.length === 0 && <p class="quiet">No rule depends on the position. Draw a zone.</p>}
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
  const place = rule.zones.length === 1 && first ? sidesWords(first.rectangle) : `${rule.zones.length} rectangles`;
  const others = rule.others.length > 0 ? `, if also ${rule.others.join(" and ")}` : "";
  return `${topics}: ${place}${rule.holds_elsewhere ? "" : others}${rule.holds_elsewhere ? "; it can hold elsewhere too" : ""}`;
}

const KINDS = { map: "Map", image: "Image", bag: "Recording" };

/** What lies below the zones. */
export function FloorChoice({ floor, editor }: { floor: MapFloor; editor: RuleEditor }) {
  const { kind, name, bag } = editor.map.value;
  const choices = floor.choices.value;
  const pictures = choices.filter((choice) => choice.kind !== "bag");
  const bags = choices.filter((choice) => choice.kind === "bag");
  const pick = (value: string) => floor.choose(pictures.find((choice) => keyOf(choice) === value) ?? null);
  return (
    <div class="floor-bar">
      <Choice
        label="Background"
        value={kind === null ? "" : `${kind} ${name}`}
        choices={[
          ["", "Plain grid"],
          ...pictures.map((choice) => [keyOf(choice), `${KINDS[choice.kind]}: ${choice.name}`] as const),
        ]}
        choose={pick}
      />
      <Choice
        label="Path of"
        value={bag ?? ""}
        choices={[["", "no recording"], ...bags.map((choice) => choice.name)]}
        choose={(path) => floor.choosePath(path || null)}
      />
    </div>
  );
}

/** Where an image lies, and what somebody should know of what lies below the zones; `topics` are those of zones. */
function FloorNotes({ floor, editor, topics }: { floor: MapFloor; editor: RuleEditor; topics: string[] }) {
  const { kind, name } = editor.map.value;
  return (
    <div class="floor-notes">
      <PoseNote floor={floor} topics={topics} hasMap={kind === "map"} />
      {kind === "image" && <ImagePlace floor={floor} editor={editor} />}
      {floor.hasChanged.value && (
        <Notice
          kind="warning"
          text={`${name} has changed since it was chosen here: check that the zones are still right.`}
          action={{ label: "They are right", act: () => floor.accept() }}
        />
      )}
      <Notes notes={floor.notices.value} />
    </div>
  );
}

/** Whose positions the path shows, and whether those of the zones are of the same frame. */
function PoseNote({ floor, topics, hasMap }: { floor: MapFloor; topics: string[]; hasMap: boolean }) {
  const driven = floor.driven.value;
  const others = topics.filter((topic) => topic !== driven?.source);
  const notes = driven
    ? [`The path is that of ${driven.source}${driven.frame && `, in the frame ${driven.frame}`}.`]
    : [];
  if (driven && others.length > 0) notes.push(`Zones read ${others.join(", ")}, whose positions may lie elsewhere.`);
  if (hasMap && driven?.frame !== MAP_FRAME && (driven || topics.length > 0))
    notes.push(
      `Positions of ${driven?.source ?? topics.join(", ")} fit the map if the robot started at the map's origin.`,
    );
  return notes.length > 0 ? <p class="quiet">{notes.join(" ")}</p> : null;
}

const keyOf = (choice: BackgroundChoice) => `${choice.kind} ${choice.name}`;

const FIELDS = [
  { field: "metres_per_pixel", label: "Metres per pixel" },
  { field: "x", label: "Lower left corner x (m)" },
  { field: "y", label: "Lower left corner y (m)" },
  { field: "yaw_deg", label: "Turned by (°)" },
] as const;

/** The scale and place of an image, which only a person can know. */
function ImagePlace({ floor, editor }: { floor: MapFloor; editor: RuleEditor }) {
  const { metres_per_pixel, x, y, yaw_deg } = editor.map.value;
  const place = { metres_per_pixel, x, y, yaw_deg };
  const [problem, setProblem] = useState("");
  const change = (field: keyof typeof place, label: string, text: string) => {
    const value = typedNumber(text);
    const isTooSmall = field === "metres_per_pixel" && value <= 0;
    const wrong = isTooSmall ? `${text.trim()} is not more than 0` : numberProblem(text);
    setProblem(wrong && `${label}: ${wrong}.`);
    if (wrong === "" && Number.isFinite(value)) floor.place({ ...place, [field]: value });
  };
  return (
    <div class="row image-place">
      {FIELDS.map(({ field, label }) => (
        <label key={field}>
          {label}
          <input
            inputMode="decimal"
            value={place[field]}
            onChange={(event) => change(field, label, event.currentTarget.value)}
          />
        </label>
      ))}
      <Problem text={problem} />
    </div>
  );
}
