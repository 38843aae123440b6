// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type Feature from "ol/Feature";
import Polygon, { fromExtent } from "ol/geom/Polygon";
import Draw, { createBox } from "ol/interaction/Draw";
import Snap from "ol/interaction/Snap";
import type OlMap from "ol/Map";
import type VectorSource from "ol/source/Vector";
import type Style from "ol/style/Style";
import {
  bounded,
  closed,
  type Extent,
  type MapOwner,
  type MapZone,
  type Point,
  type Tool,
  toCentimetres,
} from "./shapes";
import { type DragOwner, ZoneDrag } from "./zone_drag";

const SNAP_PX = 8;

/** Choosing, dragging and drawing of zones. */
export class ZoneTools {
  private readonly drag: ZoneDrag;
  private readonly snap: Snap;
  private draw: Draw | null = null;

  constructor(
    private readonly map: OlMap,
    private readonly source: VectorSource<Feature>,
    private readonly zones: () => readonly MapZone[],
    private readonly around: () => Extent,
    private readonly sketch: () => Style[],
    private readonly owner: MapOwner,
  ) {
    this.drag = new ZoneDrag(this.dragOwner());
    this.snap = new Snap({ source, pixelTolerance: SNAP_PX });
    this.drag.setActive(owner.chosen !== undefined);
    map.addInteraction(this.drag);
    map.on("click", ({ pixel }) => {
      if (this.draw) return;
      const found = this.smallestAt(pixel);
      owner.chosen?.(found?.id ?? null, found?.rectangle ?? 0);
    });
  }

  use(tool: Tool): void {
    if (this.draw) {
      this.map.removeInteraction(this.draw);
      this.map.removeInteraction(this.snap);
    }
    this.draw = tool === "choose" ? null : this.newDraw(tool);
    this.drag.setActive(tool === "choose" && this.owner.chosen !== undefined);
    if (!this.draw) return;
    this.map.addInteraction(this.draw);
    // Snapping must see the pointer first, and what is added last does.
    this.map.addInteraction(this.snap);
  }

  removeLastCorner(): boolean {
    const corners = this.draw?.getOverlay().getSource()?.getFeatures().length ?? 0;
    if (corners === 0) return false;
    this.draw?.removeLastPoint();
    return true;
  }

  private newDraw(tool: "rectangle" | "polygon"): Draw {
    const style = this.sketch();
    // A rectangle is pulled up in one go, a polygon pressed corner by corner.
    const draw =
      tool === "rectangle"
        ? new Draw({ type: "Circle", geometryFunction: createBox(), freehand: true, style })
        : new Draw({ type: "Polygon", stopClick: true, style });
    draw.on("drawend", ({ feature }) => {
      const geometry = feature.getGeometry();
      if (geometry instanceof Polygon) this.tellDrawn(tool, geometry);
    });
    return draw;
  }

  private tellDrawn(tool: "rectangle" | "polygon", geometry: Polygon): void {
    if (tool === "rectangle") {
      const sides = geometry.getExtent().map(toCentimetres) as unknown as Extent;
      if (sides[2] > sides[0] && sides[3] > sides[1]) this.owner.drawn?.({ kind: "rectangle", sides });
      return;
    }
    const ring = geometry.getCoordinates()[0] ?? [];
    const corners = ring.slice(0, -1).map(([x = 0, y = 0]): Point => [toCentimetres(x), toCentimetres(y)]);
    if (corners.length > 2) this.owner.drawn?.({ kind: "polygon", corners });
  }

  private dragOwner(): DragOwner {
    return {
      zones: this.zones,
      around: this.around,
      isAt: (id, pixel) => this.featuresAt(pixel).some((feature) => feature.get("zone") === id),
      moved: (id, by) => this.owner.moved?.(id, by),
      resized: (id, sides) => this.owner.resized?.(id, sides),
      showMoved: (id, [dx, dy]) => {
        const zone = this.zones().find((each) => each.id === id);
        this.featuresOf(id).forEach((feature, index) => {
          const rectangle = zone?.rectangles[index];
          if (!rectangle) return;
          const [left, low, right, high] = closed(rectangle, null);
          feature.setGeometry(fromExtent([left + dx, low + dy, right + dx, high + dy]));
        });
      },
      showResized: (id, sides) => {
        const zone = this.zones().find((each) => each.id === id);
        const rectangle = zone?.rectangles[zone.handle ?? 0];
        const shape = rectangle && fromExtent([...closed(bounded(rectangle, sides), null)]);
        this.featuresOf(id)[zone?.handle ?? 0]?.setGeometry(shape);
      },
    };
  }

  /** The features of a zone, in the order of its rectangles. */
  private featuresOf(id: string): Feature[] {
    return this.source
      .getFeatures()
      .filter((feature) => feature.get("zone") === id)
      .sort((a, b) => Number(a.get("rectangle")) - Number(b.get("rectangle")));
  }

  /** The smallest rectangle at a pixel, so that none hides another. */
  private smallestAt(pixel: number[]): { id: string; rectangle: number } | null {
    const area = (feature: Feature) => (feature.getGeometry() as Polygon).getArea();
    const [smallest] = this.featuresAt(pixel).sort((a, b) => area(a) - area(b));
    return smallest ? { id: String(smallest.get("zone")), rectangle: Number(smallest.get("rectangle")) } : null;
  }

  /** The rectangles of zones at a pixel; where zones clash is no zone. */
  private featuresAt(pixel: number[]): Feature[] {
    const clashes = new Set(
      this.zones()
        .filter((zone) => zone.tone === "clash")
        .map((zone) => zone.id),
    );
    const place = this.map.getCoordinateFromPixel(pixel);
    return this.source.getFeaturesAtCoordinate(place).filter((feature) => !clashes.has(String(feature.get("zone"))));
  }
}
