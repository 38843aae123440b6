// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, effect, signal, untracked } from "@preact/signals";
import type { Edit, RuleZones, ZoneRectangle, ZonesAnswer } from "../api/types";
import type { Drawn, MapZone, Point } from "../map/shapes";
import type { RuleEditor } from "./rule_editor";

export const DRAFT = "draft";
export const USUAL_RECTANGLES = 8;

/** A zone that is not in the text yet, without rectangles before it is drawn or typed; `corners` are those of a polygon, with the areas it and its cover have. */
export interface Draft {
  shape: "rectangle" | "polygon";
  rectangles: readonly ZoneRectangle[];
  polygon: { corners: readonly Point[]; area_m2: number; over_m2: number; most: number } | null;
}

/** The zones of the open file, the one that is chosen, and the one that is being made. */
export class ZoneEditor {
  /** What the server says of `text`. */
  readonly answer = signal<{ zones: ZonesAnswer; text: string } | null>(null);
  readonly draft = signal<Draft | null>(null);
  /** The rectangle of a rule whose place the next one that is drawn takes. */
  readonly redrawn = signal<{ rule: string; rectangle: ZoneRectangle } | null>(null);
  /** Which rectangle of the chosen rule. */
  readonly index = signal(0);
  readonly rules = computed(() => this.answer.value?.zones.rules ?? []);
  /** The topics whose positions the zones read, in their order. */
  readonly topics = computed(() => [
    ...new Set(this.rules.value.flatMap((rule) => rule.zones.map((zone) => zone.topic))),
  ]);
  /** The rule that the cursor, a block or the map points at, if it has zones. */
  readonly chosen = computed((): RuleZones | null => {
    const { spot } = this.editor;
    const id = spot.value && this.editor.statementAt(spot.value.offset)?.id;
    return this.rules.value.find((rule) => rule.id === id && rule.zones.length > 0) ?? null;
  });
  readonly shown = computed((): MapZone[] => this.zonesToShow());

  constructor(readonly editor: RuleEditor) {}

  /** Asks anew whenever the server has read the text; returns how to stop. */
  follow(): () => void {
    return effect(() => {
      void this.editor.document.value;
      untracked(() => void this.ask());
    });
  }

  choose(id: string | null, rectangle = 0): void {
    if (id === DRAFT) return;
    this.index.value = rectangle;
    this.editor.point(this.editor.statement(id), "map");
  }

  /** Moves all zones of a rule, or the draft. */
  async move(id: string, [dx, dy]: Point): Promise<void> {
    const zones = this.rules.value.find((rule) => rule.id === id)?.zones;
    const topic = (zones?.[this.index.value] ?? zones?.[0])?.topic;
    if (id === DRAFT) this.moveDraft(dx, dy);
    else if (topic !== undefined) await this.change({ kind: "zone_move", id, topic, dx, dy });
  }

  /** Gives one rectangle other sides. */
  async resize(id: string, index: number, rectangle: ZoneRectangle): Promise<void> {
    if (id === DRAFT) this.draft.value = drawn(rectangle);
    else await this.change({ kind: "zone_resize", id, index, rectangle });
  }

  async draw(shape: Drawn): Promise<void> {
    if (shape.kind === "polygon") return this.cover(shape.corners, USUAL_RECTANGLES);
    const [min_x_m, min_y_m, max_x_m, max_y_m] = shape.sides;
    const rectangle = { min_x_m, max_x_m, min_y_m, max_y_m };
    const old = this.redrawn.value;
    this.redrawn.value = null;
    const zones = this.rules.value.find(({ id }) => id === old?.rule)?.zones ?? [];
    const index = zones.findIndex((zone) => isSame(zone.rectangle, old?.rectangle));
    if (old === null || index < 0) this.draft.value = drawn(rectangle);
    else await this.resize(old.rule, index, rectangle);
  }

  /** Waits for somebody to draw a rectangle of a rule anew. */
  redraw(rule: string, rectangle: ZoneRectangle): void {
    this.draft.value = null;
    this.redrawn.value = { rule, rectangle };
    this.choose(rule);
  }

  /** Nobody draws any more: forgets what was not begun. */
  putAway(): void {
    this.redrawn.value = null;
    if (this.draft.value?.rectangles.length === 0) this.draft.value = null;
  }

  /** Makes a draft of the rectangles that cover a polygon. */
  async cover(corners: readonly Point[], most: number): Promise<void> {
    await this.editor.attempt(async () => {
      const { rectangles, polygon_m2, over_m2 } = await this.editor.api.ask("POST /api/zones/cover", {
        corners: corners.map(([x, y]) => [x, y]),
        max_rectangles: most,
      });
      this.draft.value = { shape: "polygon", rectangles, polygon: { corners, area_m2: polygon_m2, over_m2, most } };
    });
  }

  /** Forgets the draft; whether there was one. */
  discard(): boolean {
    const hadDraft = this.draft.value !== null;
    this.draft.value = null;
    return hadDraft;
  }

  /** Puts the draft into the text: as a rule of its own, or into the rule `into`. */
  async add(topic: string, label: string, into: string | null): Promise<void> {
    const draft = this.draft.value;
    if (!draft) return;
    const isDone = await this.change({ kind: "zone_new", topic, rectangles: [...draft.rectangles], into, label });
    if (!isDone) return;
    this.draft.value = null;
    const made = this.rules.value.filter((rule) => (into === null ? rule.label === label : rule.id === into)).at(-1);
    this.choose(made?.id ?? null);
  }

  /** Does one edit as one step of undo; whether it was done. What is refused is told, and drawn as it was. */
  private async change(edit: Edit): Promise<boolean> {
    const known = this.answer.peek()?.text;
    // A new rule fits every text; any other edit names a rule of the text that the map shows.
    const isNewRule = edit.kind === "zone_new" && edit.into === null;
    let before = null as string | null;
    await this.editor.edit(() => {
      const text = this.editor.text.peek();
      before = isNewRule || known === text ? text : null;
      return before === null ? [] : [edit];
    });
    const isDone = before !== null && this.editor.text.peek() !== before;
    await this.ask();
    return isDone;
  }

  private async ask(): Promise<void> {
    const { rules } = this.editor;
    await this.editor.attempt(async () => {
      const zones = await this.editor.api.ask("POST /api/zones", rules);
      if (rules.text === this.editor.text.peek()) this.answer.value = { zones, text: rules.text };
    });
  }

  private moveDraft(dx: number, dy: number): void {
    const { draft } = this;
    if (!draft.value) return;
    const { shape, rectangles, polygon } = draft.value;
    const corners = polygon?.corners.map(([x, y]): Point => [rounded(x + dx), rounded(y + dy)]) ?? [];
    draft.value = {
      shape,
      rectangles: rectangles.map((one) => ({
        min_x_m: shifted(one.min_x_m, dx),
        max_x_m: shifted(one.max_x_m, dx),
        min_y_m: shifted(one.min_y_m, dy),
        max_y_m: shifted(one.max_y_m, dy),
      })),
      polygon: polygon && { ...polygon, corners },
    };
  }

  private zonesToShow(): MapZone[] {
    const chosen = this.chosen.value;
    const draft = this.draft.value;
    const canEdit = !this.editor.isBroken.value && draft === null;
    const zones = this.rules.value.map((rule): MapZone => {
      const isChosen = rule.id === chosen?.id;
      const rectangles = rule.zones.map((zone) => zone.rectangle);
      const tone = isChosen ? "selected" : "zone";
      const grip =
        isChosen && canEdit ? { movable: true, handle: Math.min(this.index.value, rectangles.length - 1) } : {};
      return { id: rule.id, label: rule.label, rectangles, tone, ...grip };
    });
    const clashes = (this.answer.value?.zones.clashes ?? []).map(({ common }, index): MapZone => {
      return { id: `clash ${index}`, label: "clash", rectangles: common, tone: "clash" };
    });
    if (!draft?.rectangles.length) return [...zones, ...clashes];
    const handle = draft.polygon ? undefined : 0;
    return [
      ...zones,
      ...clashes,
      { id: DRAFT, label: "new zone", rectangles: draft.rectangles, tone: "draft", movable: true, handle },
    ];
  }
}

/** A draft of one rectangle. */
export function drawn(rectangle: ZoneRectangle): Draft {
  return { shape: "rectangle", rectangles: [rectangle], polygon: null };
}

function isSame(one: ZoneRectangle, other: ZoneRectangle | undefined): boolean {
  return JSON.stringify(Object.entries(one).sort()) === JSON.stringify(Object.entries(other ?? {}).sort());
}

function shifted(value: number | null, by: number): number | null {
  return value === null ? null : rounded(value + by);
}

/** Without the dust of binary fractions; zones are written in centimetres, or as finely as somebody typed. */
function rounded(value: number): number {
  return Number(value.toFixed(6));
}
