// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { computed, effect, type Signal, signal, untracked } from "@preact/signals";
import type { Api } from "../api/client";
import type { Background, BackgroundChoice, DrivenPath } from "../api/types";
import type { MapPicture, Point } from "../map/shapes";
import { type MapSetting, PLAIN_GRID } from "./layout";

const RADIANS = Math.PI / 180;
export const MAP_FRAME = "map";
const NO_PATH: readonly Point[] = [];

/** What a floor belongs to: its side file names the map, and it says what was refused. */
interface FloorOwner {
  readonly api: Api;
  readonly map: Signal<MapSetting>;
  attempt(work: () => Promise<void>): Promise<unknown>;
}

/** What lies below the zones: a map or image, and the path of a recording. The choice is kept in the side file. */
export class MapFloor {
  readonly choices = signal<readonly BackgroundChoice[]>([]);
  readonly background = signal<Background | null>(null);
  readonly driven = signal<DrivenPath | null>(null);
  readonly picture = computed((): MapPicture | null => pictureOf(this.background.value, this.editor.map.value));
  readonly path = computed(() => this.driven.value?.path.map(([, x, y]): Point => [x, y]) ?? NO_PATH);
  /** The topic whose positions are in the frame of maps, if rules can read them. */
  readonly poseInMap = computed(() => {
    const driven = this.driven.value;
    return driven?.frame === MAP_FRAME && driven.has_pose ? driven.source : null;
  });
  readonly notices = computed(() => this.driven.value?.notices ?? []);
  /** Whether the files of the map are others than when it was chosen. */
  readonly hasChanged = computed(() => {
    const [found, known] = [this.background.value, this.editor.map.value];
    return found !== null && known.hash !== "" && found.hash !== known.hash;
  });

  constructor(private readonly editor: FloorOwner) {}

  /** Loads what the side file names, now and when that changes; returns how to stop. */
  follow(): () => void {
    const bag = computed(() => this.editor.map.value.bag);
    void this.editor.attempt(async () => {
      this.choices.value = (await this.editor.api.ask("GET /api/backgrounds", null)).choices;
    });
    const stops = [
      this.followPicture(),
      effect(() => {
        const which = bag.value;
        untracked(() => void this.editor.attempt(() => this.loadPath(which)));
      }),
    ];
    return () => {
      for (const stop of stops) stop();
    };
  }

  /** Loads the map or image that the side file names, now and when that changes; returns how to stop. */
  followPicture(): () => void {
    const kind = computed(() => this.editor.map.value.kind);
    const name = computed(() => this.editor.map.value.name);
    return effect(() => {
      const [what, which] = [kind.value, name.value];
      untracked(() => void this.editor.attempt(() => this.loadBackground(what, which)));
    });
  }

  /** Draws on another map or image from now on. */
  choose(choice: BackgroundChoice | null): void {
    const { bag } = this.editor.map.value;
    const isPicture = choice !== null && choice.kind !== "bag";
    this.set({ ...PLAIN_GRID, bag, ...(isPicture ? { kind: choice.kind as "map" | "image", name: choice.name } : {}) });
  }

  choosePath(bag: string | null): void {
    this.set({ ...this.editor.map.value, bag });
  }

  /** Says where an image lies. */
  place(place: Pick<MapSetting, "metres_per_pixel" | "x" | "y" | "yaw_deg">): void {
    this.set({ ...this.editor.map.value, ...place });
  }

  /** The zones lie right on the map as it is now. */
  accept(): void {
    this.set({ ...this.editor.map.value, hash: this.background.value?.hash ?? "" });
  }

  private set(setting: MapSetting): void {
    this.editor.map.value = setting;
  }

  private async loadBackground(kind: MapSetting["kind"], name: string): Promise<void> {
    this.background.value = null;
    if (kind === null) return;
    const found = await this.editor.api.ask("POST /api/background", { kind, name });
    if (this.editor.map.peek().name !== name) return;
    this.background.value = found;
    if (this.editor.map.peek().hash === "") this.accept();
  }

  private async loadPath(bag: string | null): Promise<void> {
    this.driven.value = null;
    if (bag === null) return;
    const found = await this.editor.api.ask("POST /api/background/path", { bag });
    if (this.editor.map.peek().bag === bag) this.driven.value = found;
  }
}

function pictureOf(background: Background | null, said: MapSetting): MapPicture | null {
  if (background === null || background.name !== said.name) return null;
  const { kind, name, hash, width_px, height_px } = background;
  const isStencil = kind === "map";
  const scale = background.metres_per_pixel ?? said.metres_per_pixel;
  const place = isStencil ? background : { x: said.x, y: said.y, yaw_rad: said.yaw_deg * RADIANS };
  return {
    url: `api/background/picture?${new URLSearchParams({ kind, name, hash })}`,
    width_m: width_px * scale,
    height_m: height_px * scale,
    x: place.x,
    y: place.y,
    yaw_rad: place.yaw_rad,
    is_stencil: isStencil,
  };
}
