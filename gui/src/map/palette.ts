// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import CircleStyle from "ol/style/Circle";
import Fill from "ol/style/Fill";
import RegularShape from "ol/style/RegularShape";
import Stroke from "ol/style/Stroke";
import Style from "ol/style/Style";
import Text from "ol/style/Text";
import { styleOf } from "../ui/watch";
import type { MapZone } from "./shapes";

/** The colours of the page, as a canvas needs them. */
export interface Palette {
  text: string;
  quiet: string;
  surface: string;
  line: string;
  lineStrong: string;
  accent: string;
  error: string;
  info: string;
  font: string;
}

export function paletteOf(host: HTMLElement): Palette {
  const value = styleOf(host);
  return {
    text: value("--text"),
    quiet: value("--text-2"),
    surface: value("--surface"),
    line: value("--line"),
    lineStrong: value("--line-strong"),
    accent: value("--accent"),
    error: value("--error"),
    info: value("--info"),
    font: value("--font"),
  };
}

/** How a zone looks; clashing and drafted ones differ in their line as well, not in colour only. */
export function zoneStyle(palette: Palette, tone: MapZone["tone"]): Style {
  const colour = { zone: palette.info, selected: palette.accent, clash: palette.error, draft: palette.accent }[tone];
  const lineDash = { zone: null, selected: null, clash: [2, 4], draft: [8, 5] }[tone];
  return new Style({
    fill: new Fill({ color: `${colour}${tone === "clash" ? "40" : "26"}` }),
    stroke: new Stroke({ color: colour, width: tone === "zone" ? 1.5 : 2.5, ...(lineDash ? { lineDash } : {}) }),
    zIndex: { zone: 1, clash: 2, draft: 3, selected: 4 }[tone],
  });
}

export function labelStyle(palette: Palette, label: string): Style {
  return new Style({
    text: new Text({
      text: label,
      font: `600 12px ${palette.font}`,
      fill: new Fill({ color: palette.text }),
      stroke: new Stroke({ color: palette.surface, width: 3 }),
      overflow: true,
    }),
    zIndex: 5,
  });
}

export function handleStyle(palette: Palette): Style {
  const [fill, stroke] = [new Fill({ color: palette.surface }), new Stroke({ color: palette.accent, width: 2 })];
  return new Style({ image: new RegularShape({ points: 4, radius: 8, angle: Math.PI / 4, fill, stroke }), zIndex: 9 });
}

export function pathStyle(palette: Palette): Style {
  return new Style({ stroke: new Stroke({ color: palette.quiet, width: 2 }) });
}

export function dotStyle(palette: Palette): Style {
  return new Style({ image: new CircleStyle({ radius: 4, fill: new Fill({ color: palette.accent }) }), zIndex: 5 });
}

/** The robot: a ring where it is, and an arrow where it looks, if that is known. */
export function robotStyle(palette: Palette, heading_rad: number | null): Style[] {
  const [fill, stroke] = [new Fill({ color: palette.accent }), new Stroke({ color: palette.surface, width: 2 })];
  const ring = new Style({ image: new CircleStyle({ radius: 8, fill, stroke }), zIndex: 10 });
  if (heading_rad === null) return [ring];
  const rotation = Math.PI / 2 - heading_rad;
  const arrow = new RegularShape({ points: 3, radius: 12, rotation, fill, stroke, displacement: [0, 0] });
  return [ring, new Style({ image: arrow, zIndex: 11 })];
}
