// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type Feature from "ol/Feature";
import Polygon, { fromExtent } from "ol/geom/Polygon";
import Draw, { createBox } from "ol/interaction/Draw";
import PointerInteraction from "ol/interaction/Pointer";
import Snap from "ol/interaction/Snap";
import type OlMap from "ol/Map";
import type MapBrowserEvent from "ol/MapBrowserEvent";
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
      if (geometry instanceof Polygon) this.reportDrawn(tool, geometry);
    });
    return draw;
  }

  private reportDrawn(tool: "rectangle" | "polygon", geometry: Polygon): void {
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

const GRIP_PX = 14;
const LEAST_SIDE_M = 0.01;
/** Sides shorter than this have no handle in their middle; rectangles smaller than the other have none at all. */
const LEAST_PX = { middle: 64, any: 32 };

/** A place to take hold of a rectangle: which of its sides follow the pointer (-1 the lower one, 1 the upper). */
interface Handle {
  place: Point;
  x: -1 | 0 | 1;
  y: -1 | 0 | 1;
}

/**
 * The handles of the rectangle that has them: its corners and the middles of its sides, where they are bounded.
 *
 * `resolution` is metres per pixel: what is too small to take hold of can be moved, or made larger by zooming in.
 */
export function handlesOf(zones: readonly MapZone[], around: Extent, resolution: number): Handle[] {
  const zone = zones.find((each) => each.handle !== undefined);
  const rectangle = zone?.rectangles[zone.handle ?? 0];
  if (!rectangle) return [];
  const [left, low, right, high] = closed(rectangle, around);
  const sides = { x: [rectangle.min_x_m, rectangle.max_x_m], y: [rectangle.min_y_m, rectangle.max_y_m] };
  const isBounded = (axis: "x" | "y", side: number) => side === 0 || sides[axis][side < 0 ? 0 : 1] !== null;
  const px = { x: (right - left) / resolution, y: (high - low) / resolution };
  const hasRoom = (x: number, y: number) =>
    (x !== 0 || px.x >= LEAST_PX.middle) &&
    (y !== 0 || px.y >= LEAST_PX.middle) &&
    Math.max(px.x, px.y) >= LEAST_PX.any;
  const at = (side: number, from: number, to: number) => (side === 0 ? (from + to) / 2 : side < 0 ? from : to);
  const steps = [-1, 0, 1] as const;
  return steps
    .flatMap((x) => steps.map((y): Handle => ({ x, y, place: [at(x, left, right), at(y, low, high)] })))
    .filter(({ x, y }) => (x !== 0 || y !== 0) && isBounded("x", x) && isBounded("y", y) && hasRoom(x, y));
}

/** What a drag does with zones, and where it shows while it lasts. */
interface DragOwner {
  zones: () => readonly MapZone[];
  around: () => Extent;
  /** Whether a zone lies under the pointer. */
  isAt: (id: string, pixel: number[]) => boolean;
  /** Draws a zone moved by so much, for now. */
  showMoved: (id: string, by: Point) => void;
  moved: (id: string, by: Point) => void;
  /** Draws the rectangle with the handles with other sides, for now. */
  showResized: (id: string, sides: Extent) => void;
  resized: (id: string, sides: Extent) => void;
}

type Grip = { id: string; start: Point } & ({ kind: "move" } | { kind: "resize"; handle: Handle; sides: Extent });

/** Drags zones about, and rectangles by their handles, in whole centimetres. */
class ZoneDrag extends PointerInteraction {
  private grip: Grip | null = null;
  private last: Point | null = null;

  constructor(private readonly owner: DragOwner) {
    super();
  }

  override handleDownEvent(event: MapBrowserEvent): boolean {
    this.last = null;
    this.grip = this.handleAt(event) ?? this.zoneAt(event);
    return this.grip !== null;
  }

  override handleDragEvent(event: MapBrowserEvent): void {
    if (!this.grip) return;
    this.last = placeOf(event);
    if (this.grip.kind === "move") this.owner.showMoved(this.grip.id, this.by());
    else this.owner.showResized(this.grip.id, this.sides(this.grip.handle, this.grip.sides));
  }

  override handleUpEvent(): boolean {
    const { grip } = this;
    if (grip && this.last) {
      if (grip.kind === "move") this.owner.moved(grip.id, this.by());
      else this.owner.resized(grip.id, this.sides(grip.handle, grip.sides));
    }
    this.grip = null;
    return false;
  }

  override handleMoveEvent(event: MapBrowserEvent): void {
    const isOverZone = this.handleAt(event) !== null || this.zoneAt(event) !== null;
    const target = event.map.getTargetElement();
    if (target) target.style.cursor = isOverZone ? "move" : "";
  }

  private handleAt(event: MapBrowserEvent): Grip | null {
    const zone = this.owner.zones().find((each) => each.handle !== undefined);
    const rectangle = zone?.rectangles[zone.handle ?? 0];
    if (!zone || !rectangle) return null;
    const around = this.owner.around();
    const [x = 0, y = 0] = event.pixel;
    const resolution = event.map.getView().getResolution() ?? 1;
    const near = handlesOf([zone], around, resolution).find(({ place }) => {
      const [left = 0, top = 0] = event.map.getPixelFromCoordinate([...place]);
      return Math.hypot(left - x, top - y) <= GRIP_PX;
    });
    if (!near) return null;
    return { kind: "resize", id: zone.id, start: placeOf(event), handle: near, sides: closed(rectangle, around) };
  }

  private zoneAt(event: MapBrowserEvent): Grip | null {
    const zone = this.owner.zones().find((each) => each.movable && this.owner.isAt(each.id, event.pixel));
    return zone ? { kind: "move", id: zone.id, start: placeOf(event) } : null;
  }

  private by(): Point {
    const [from, to] = [this.grip?.start ?? [0, 0], this.last ?? [0, 0]];
    return [toCentimetres(to[0] - from[0]), toCentimetres(to[1] - from[1])];
  }

  private sides(handle: Handle, sides: Extent): Extent {
    const [left, low, right, high] = sides;
    const [x, y] = (this.last ?? [0, 0]).map(toCentimetres) as [number, number];
    return [
      handle.x < 0 ? Math.min(x, right - LEAST_SIDE_M) : left,
      handle.y < 0 ? Math.min(y, high - LEAST_SIDE_M) : low,
      handle.x > 0 ? Math.max(x, left + LEAST_SIDE_M) : right,
      handle.y > 0 ? Math.max(y, low + LEAST_SIDE_M) : high,
    ];
  }
}

function placeOf(event: MapBrowserEvent): Point {
  const [x = 0, y = 0] = event.coordinate;
  return [x, y];
}
