// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import type { BackgroundChoice } from "../api/types";
import { MAP_FRAME, type MapFloor } from "../state/map_floor";
import type { RuleEditor } from "../state/rule_editor";
import { Choice } from "../ui/choice";
import { Notice, Problem } from "../ui/notice";
import { numberProblem, typedNumber } from "../ui/numbers";

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
export function FloorNotes({ floor, editor, topics }: { floor: MapFloor; editor: RuleEditor; topics: string[] }) {
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
      {floor.notices.value.map((notice) => (
        <p key={notice} class="quiet">
          {notice}
        </p>
      ))}
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
