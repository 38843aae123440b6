// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type Feature from "ol/Feature";
import type OlMap from "ol/Map";
import Polygon, { fromExtent } from "ol/geom/Polygon";
import Draw, { createBox } from "ol/interaction/Draw";
import Snap from "ol/interaction/Snap";
import type VectorSource from "ol/source/Vector";
import type { MapOwner, Tool } from "./map_owner";
import { closed, type Extent, type MapZone, type Point, toCentimetres } from "./shapes";
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
    private readonly owner: MapOwner,
  ) {
    this.drag = new ZoneDrag(this.dragOwner());
    this.snap = new Snap({ source, pixelTolerance: SNAP_PX });
    this.drag.setActive(owner.chosen !== undefined);
    map.addInteraction(this.drag);
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
    // A rectangle is pulled up in one go, a polygon pressed corner by corner.
    const draw =
      tool === "rectangle"
        ? new Draw({ type: "Circle", geometryFunction: createBox(), freehand: true })
        : new Draw({ type: "Polygon", stopClick: true });
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
      zoneAt: (pixel) => this.zoneAt(pixel),
      chosen: (id) => this.owner.chosen?.(id),
      moved: (id, by) => this.owner.moved?.(id, by),
      resized: (id, sides) => this.owner.resized?.(id, sides),
      showMoved: (id, [dx, dy]) => {
        const zone = this.zones().find((each) => each.id === id);
        this.featuresOf(id).forEach((feature, index) => {
          const rectangle = zone?.rectangles[index];
          if (!rectangle) return;
          const [left, low, right, high] = closed(rectangle, this.around());
          feature.setGeometry(fromExtent([left + dx, low + dy, right + dx, high + dy]));
        });
      },
      showResized: (id, sides) => {
        const handle = this.zones().find((each) => each.id === id)?.handle ?? 0;
        this.featuresOf(id)[handle]?.setGeometry(fromExtent([...sides]));
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

  /** The zone at a pixel; of several the smallest, so that none hides another. */
  private zoneAt(pixel: number[]): string | null {
    const found = this.map.getFeaturesAtPixel(pixel, { layerFilter: (layer) => layer.get("source") === this.source });
    const area = (each: (typeof found)[number]) => (each.getGeometry() instanceof Polygon ? (each.getGeometry() as Polygon).getArea() : 0);
    const [smallest] = found.sort((a, b) => area(a) - area(b));
    return (smallest?.get("zone") as string | undefined) ?? null;
  }
}
