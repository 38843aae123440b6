// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { expect } from "vitest";
import { commands, type Locator, page } from "vitest/browser";
import { boxOf, type RulerPage, twoPictures, typedIn } from "./ruler_page";

/** A place on the map in metres, or on the screen in pixels. */
export type Place = readonly [x: number, y: number];

const PLACE = /x (-?[\d.]+) m, y (-?[\d.]+) m/;
const SIDES = ["x from (m)", "x to (m)", "y from (m)", "y to (m)"];
const PICTURES_AT_REST = 10;

/** Where the place (0, 0) is on the screen, and pixels per metre. */
interface Scale {
  leftPx: number;
  topPx: number;
  pxPerM: number;
}

/** The map of an open rule file, pressed and dragged in metres. */
export class MapPage {
  readonly canvas = page.getByRole("application", { name: "Zones on the map" });
  /** The form of the chosen zone, or of a new one. */
  readonly form = page.getByRole("group", { name: /^(Zone of|New zone)/ });

  private constructor(private readonly ruler: RulerPage) {}

  static async open(ruler: RulerPage): Promise<MapPage> {
    await ruler.openPane("Map");
    const map = new MapPage(ruler);
    await ruler.shown(map.canvas);
    await expect.element(page.getByText("Loading the map …")).not.toBeInTheDocument();
    // Zones come with an answer, and all that is there is fitted in anew.
    const zones = page.getByCss(".zone-list");
    const none = zones.getByText("No rule depends on the position");
    await ruler.shown(zones.getByRole("button").or(none).first());
    await atRest();
    return map;
  }

  /** The four numbers of the form. */
  sides(): string[] {
    return SIDES.map((label) => typedIn(this.form.getByLabelText(label)));
  }

  async typeSides(...sides: string[]): Promise<void> {
    for (const [at, side] of sides.entries()) await this.form.getByLabelText(SIDES[at] as string).fill(side);
  }

  /** Presses at one place, and pulls to another. */
  async drag(start: Place, end: Place): Promise<void> {
    const scale = await this.scale();
    const middle: Place = [(start[0] + end[0]) / 2, (start[1] + end[1]) / 2];
    await commands.mouseMove(...pixel(scale, start));
    await commands.mouseDown();
    await commands.mouseMove(...pixel(scale, middle));
    await commands.mouseMove(...pixel(scale, end));
    await commands.mouseUp();
  }

  async press(...places: Place[]): Promise<void> {
    const scale = await this.scale();
    for (const place of places) {
      await commands.mouseMove(...pixel(scale, place));
      await commands.mouseDown();
      await commands.mouseUp();
    }
  }

  async tool(name: string): Promise<void> {
    await this.ruler.button(name).click();
    await expect.element(this.ruler.button(name)).toHaveAttribute("aria-pressed", "true");
  }

  /** Read off at two corners of the map, after it has settled. */
  private async scale(): Promise<Scale> {
    await atRest();
    const box = await boxOf(this.canvas);
    const [left, top] = [box.left + 40, box.bottom - 60];
    const right = box.right - 80;
    const [x, y] = await placeAt(left, top);
    const [farX] = await placeAt(right, box.top + 90);
    const pxPerM = (right - left) / (farX - x);
    return { leftPx: left - x * pxPerM, topPx: top + y * pxPerM, pxPerM };
  }
}

/** What the map says of a point of the screen. */
async function placeAt(xPx: number, yPx: number): Promise<Place> {
  await commands.mouseMove(xPx, yPx);
  await twoPictures();
  const said: Locator = page.getByLabelText("Place of the pointer");
  const found = PLACE.exec(said.element().textContent ?? "");
  expect(found).not.toBeNull();
  return [Number(found?.[1]), Number(found?.[2])];
}

/** Resolves when the map has had the same size and scale for some pictures. */
async function atRest(): Promise<void> {
  let [before, pictures] = ["", 0];
  while (pictures < PICTURES_AT_REST) {
    await new Promise(requestAnimationFrame);
    const host = document.querySelector(".map-host");
    const scale = document.querySelector<HTMLElement>(".map-scale");
    const now = [host?.clientWidth, host?.clientHeight, scale?.style.width, scale?.textContent].join();
    pictures = now === before ? pictures + 1 : 0;
    before = now;
  }
}

function pixel({ leftPx, topPx, pxPerM }: Scale, [x, y]: Place): [number, number] {
  return [leftPx + x * pxPerM, topPx - y * pxPerM];
}
