// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useRef, useState } from "preact/hooks";
import type { ZoneRectangle } from "../api/types";
import type { Point } from "../map/shapes";
import { type Draft, drawn, USUAL_RECTANGLES, type ZoneEditor } from "../state/zone_editor";
import { Button } from "../ui/button";
import { Choice } from "../ui/choice";
import { focusPageSoon } from "../ui/dialog";
import { Problem } from "../ui/notice";
import { numberProblem, typedNumber } from "../ui/numbers";

const SIDES = [
  { side: "min_x_m", label: "x from (m)" },
  { side: "max_x_m", label: "x to (m)" },
  { side: "min_y_m", label: "y from (m)" },
  { side: "max_y_m", label: "y to (m)" },
] as const;

/** The sides of the chosen zone as numbers, and how far to move all of it. */
export function ChosenZoneForm({ zones }: { zones: ZoneEditor }) {
  const rule = zones.chosen.value;
  const index = Math.min(zones.index.value, (rule?.zones.length ?? 1) - 1);
  const zone = rule?.zones[index];
  if (!rule || !zone) return null;
  const isMany = rule.zones.length > 1;
  return (
    <div class="zone-form" role="group" aria-label={`Zone of ${rule.label}`}>
      <div class="row zone-head">
        <h2>{rule.label}</h2>
        {isMany && (
          <Choice
            isBare
            label="Rectangle"
            value={index}
            choices={rule.zones.map((_, each) => [each, `rectangle ${each + 1} of ${rule.zones.length}`] as const)}
            choose={(each) => (zones.index.value = each)}
          />
        )}
      </div>
      <SidesForm
        rectangle={zone.rectangle}
        submit="Set the sides"
        disabled={zones.editor.isBroken.value}
        done={(sides) => sides && void zones.resize(rule.id, index, sides)}
      />
      {isMany && <MoveForm move={(by) => void zones.move(rule.id, by)} />}
      {zone.is_shared && (
        <p class="quiet">Checks of this rectangle bound others of the rule as well: they change with it.</p>
      )}
    </div>
  );
}

/** A zone that is being made: its shape, what it is called and where it goes; `topic` is proposed for it. */
export function DraftForm({ zones, topic }: { zones: ZoneEditor; topic: string }) {
  const draft = zones.draft.value;
  // What is added is what the fields say: not a draft beside which they say something else, or nothing that can be read.
  const [stale, setStale] = useState<Draft | null>(null);
  if (!draft) return null;
  return (
    <div class="zone-form" role="group" aria-label="New zone">
      <div class="row zone-head">
        <h2>New zone</h2>
      </div>
      {draft.shape === "polygon" ? (
        <PolygonForm zones={zones} draft={draft} changed={() => setStale(draft)} />
      ) : (
        <SidesForm
          rectangle={draft.rectangles[0] ?? { min_x_m: null, max_x_m: null, min_y_m: null, max_y_m: null }}
          done={(sides) => {
            if (sides) zones.draft.value = drawn(sides);
            else setStale(draft);
          }}
        />
      )}
      <GoesTo zones={zones} topic={topic} canAdd={stale !== draft && draft.rectangles.length > 0} />
    </div>
  );
}

interface SidesProps {
  rectangle: ZoneRectangle;
  /** What the button says; without one each letter counts. */
  submit?: string;
  disabled?: boolean;
  /** Null while a field holds no number. */
  done: (sides: ZoneRectangle | null) => void;
}

function SidesForm({ rectangle, submit, disabled = false, done }: SidesProps) {
  const [problem, setProblem] = useState({ key: "", text: "" });
  const given = JSON.stringify(rectangle);
  const form = useRef({ key: given, said: given });
  // New fields for what comes from elsewhere; what was typed here stays as it was typed.
  if (given !== form.current.said) form.current = { key: given, said: given };
  const read = (fields: HTMLFormElement) => {
    const data = new FormData(fields);
    const sides = Object.fromEntries(SIDES.map(({ side }) => [side, numberIn(data, side)])) as unknown as ZoneRectangle;
    const wrong = problemOf(sides);
    setProblem({ key: form.current.key, text: wrong });
    if (wrong === "" && submit === undefined) form.current.said = JSON.stringify(sides);
    done(wrong === "" ? sides : null);
  };
  return (
    <form
      class="row"
      key={form.current.key}
      onInput={(event) => submit === undefined && read(event.currentTarget)}
      onSubmit={(event) => {
        event.preventDefault();
        read(event.currentTarget);
      }}
    >
      {SIDES.map(({ side, label }) => (
        <label key={side}>
          {label}
          <input name={side} inputMode="decimal" defaultValue={String(rectangle[side] ?? "")} placeholder="open" />
        </label>
      ))}
      {submit !== undefined && (
        <button type="submit" class="small" disabled={disabled}>
          {submit}
        </button>
      )}
      {problem.text && problem.key === form.current.key && <Problem text={problem.text} />}
    </form>
  );
}

/** Why these are not the sides of a rectangle; empty where they are. */
function problemOf(sides: ZoneRectangle): string {
  const unread = SIDES.find(({ side }) => Number.isNaN(sides[side]));
  if (unread) return `"${unread.label}" is not a number.`;
  const isBelow = (from: number | null, to: number | null) => from === null || to === null || from < to;
  if (!isBelow(sides.min_x_m, sides.max_x_m)) return '"x to (m)" must be more than "x from (m)".';
  return isBelow(sides.min_y_m, sides.max_y_m) ? "" : '"y to (m)" must be more than "y from (m)".';
}

function MoveForm({ move }: { move: (by: Point) => void }) {
  const [problem, setProblem] = useState("");
  return (
    <form
      class="row"
      onSubmit={(event) => {
        event.preventDefault();
        const data = new FormData(event.currentTarget);
        const [dx, dy] = [numberIn(data, "dx") ?? 0, numberIn(data, "dy") ?? 0];
        const wrong = [dx, dy].findIndex(Number.isNaN);
        setProblem(wrong < 0 ? "" : `${numberProblem(String(data.get(wrong === 0 ? "dx" : "dy")))}.`);
        if (Number.isFinite(dx) && Number.isFinite(dy)) move([dx, dy]);
      }}
    >
      <label>
        Move all by x (m)
        <input name="dx" inputMode="decimal" defaultValue="0" />
      </label>
      <label>
        and y (m)
        <input name="dy" inputMode="decimal" defaultValue="0" />
      </label>
      <button type="submit" class="small">
        Move all
      </button>
      <Problem text={problem} />
    </form>
  );
}

/** The corners of a polygon, and what covering it with rectangles adds. */
function PolygonForm({ zones, draft, changed }: { zones: ZoneEditor; draft: Draft; changed: () => void }) {
  const { polygon } = draft;
  const corners = polygon?.corners.map(([x, y]) => `${x} ${y}`).join(", ") ?? "";
  const [problem, setProblem] = useState("");
  return (
    <form
      class="row"
      key={`${corners} ${polygon?.most}`}
      onInput={changed}
      onSubmit={(event) => {
        event.preventDefault();
        const data = new FormData(event.currentTarget);
        const read = cornersIn(String(data.get("corners")));
        setProblem(read ? "" : "Give each corner as two numbers, with commas between corners: 0 0, 4 0, 2 3.");
        if (read) void zones.cover(read, numberIn(data, "most") ?? USUAL_RECTANGLES);
      }}
    >
      <label class="wide">
        Corners: x y, x y, … (m)
        <input name="corners" defaultValue={corners} placeholder="0 0, 4 0, 2 3" />
      </label>
      <label>
        Rectangles at most
        <input name="most" inputMode="numeric" defaultValue={String(polygon?.most ?? USUAL_RECTANGLES)} />
      </label>
      <button type="submit" class="small">
        Show
      </button>
      {polygon && <p role="status">{saidOf(draft.rectangles.length, polygon.area_m2, polygon.over_m2)}</p>}
      <Problem text={problem} />
    </form>
  );
}

function saidOf(count: number, areaM2: number, overM2: number): string {
  const rectangles = count === 1 ? "1 rectangle covers" : `${count} rectangles cover`;
  if (overM2 === 0) return `${rectangles} exactly the ${areaM2.toFixed(1)} m² of the polygon.`;
  const share = ((100 * overM2) / areaM2).toFixed(0);
  return `Rules know rectangles only: ${rectangles} the polygon of ${areaM2.toFixed(1)} m² and ${overM2.toFixed(1)} m² beside it (${share} % more).`;
}

function GoesTo({ zones, topic, canAdd }: { zones: ZoneEditor; topic: string; canAdd: boolean }) {
  const { answer, editor, rules } = zones;
  return (
    <form
      class="row"
      onSubmit={(event) => {
        event.preventDefault();
        const data = new FormData(event.currentTarget);
        const text = (name: string) => String(data.get(name) ?? "").trim();
        const label = text("label") || (answer.value?.zones.label ?? "Zone");
        void zones.add(text("topic") || topic, label, text("into") || null).then(focusZoneSoon);
      }}
    >
      <label>
        Goes to
        <select name="into">
          <option value="">a new rule</option>
          {rules.value.map((rule) => (
            <option key={rule.id} value={rule.id}>
              {rule.label}: {rule.zones.length > 0 ? "here as well" : "here only"}
            </option>
          ))}
        </select>
      </label>
      <label>
        Name of the new rule
        <input name="label" defaultValue={answer.value?.zones.label ?? ""} />
      </label>
      <label>
        Position from
        <input name="topic" defaultValue={topic} />
      </label>
      <div class="row zone-buttons">
        <button
          type="submit"
          class="small primary"
          disabled={!canAdd || editor.isBroken.value || answer.value === null}
        >
          Add the zone
        </button>
        <Button
          label="Discard"
          class="small"
          onClick={() => {
            zones.discard();
            focusPageSoon();
          }}
        />
      </div>
    </form>
  );
}

/** Gives the focus to the zone that was made, as its form is gone, once the list shows it. */
function focusZoneSoon(): void {
  requestAnimationFrame(() => {
    if (document.activeElement === document.body)
      document.querySelector<HTMLElement>('.zone-list [aria-pressed="true"]')?.focus();
  });
}

/** The number in a field, null for an empty one, NaN for anything else. */
function numberIn(data: FormData, name: string): number | null {
  const text = String(data.get(name) ?? "").trim();
  return text === "" ? null : typedNumber(text);
}

/** Corners with a semicolon or a comma between; a comma without a blank behind it may stand before decimals. */
function cornersIn(text: string): Point[] | null {
  return cornersBetween(text, /;|,\s/) ?? cornersBetween(text, /[,;]/);
}

function cornersBetween(text: string, separator: RegExp): Point[] | null {
  const corners = text
    .split(separator)
    .filter((each) => each.trim() !== "")
    .map((each) =>
      each
        .trim()
        .split(/\s+/)
        .map((word) => typedNumber(word)),
    );
  const isRead = corners.length > 2 && corners.every((each) => each.length === 2 && each.every(Number.isFinite));
  return isRead ? corners.map(([x = 0, y = 0]): Point => [x, y]) : null;
}
