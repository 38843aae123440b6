// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { platformModifierKeyOnly } from "ol/events/condition";
import { getCenter, getIntersection, intersects } from "ol/extent";
import Feature from "ol/Feature";
import LineString from "ol/geom/LineString";
import MultiPoint from "ol/geom/MultiPoint";
import OlPoint from "ol/geom/Point";
import { fromExtent } from "ol/geom/Polygon";
import { defaults as usualInteractions } from "ol/interaction/defaults";
import MouseWheelZoom from "ol/interaction/MouseWheelZoom";
import VectorLayer from "ol/layer/Vector";
import OlMap from "ol/Map";
import Projection from "ol/proj/Projection";
import VectorSource from "ol/source/Vector";
import type Style from "ol/style/Style";
import View from "ol/View";
import { FloorLayer, niceStep } from "./floor_layer";
import {
  dotStyle,
  handleStyle,
  labelStyle,
  type Palette,
  paletteOf,
  pathStyle,
  robotStyle,
  zoneStyle,
} from "./palette";
import {
  closed,
  cornersOf,
  type Extent,
  extentOf,
  finiteCorners,
  grown,
  type MapOwner,
  type MapPicture,
  type MapZone,
  type Point,
  type Tool,
  widened,
} from "./shapes";
import { handlesOf } from "./zone_drag";
import { ZoneTools } from "./zone_tools";

const USUAL_EXTENT: Extent = [-10, -10, 10, 10];
const SCALE_PX = 90;
/** How much is seen around places that are seen from near. */
const AROUND_M = 3;
/** What buttons and the scale cover: above, right, below, left. */
const FIT_MARGINS_PX = [50, 54, 28, 30];

/** The map itself, in metres, x to the right and y up. `MapCanvas` is how the page uses it. */
export class MapView {
  private readonly map: OlMap;
  private readonly floor: FloorLayer;
  private readonly ground = new VectorSource<Feature>();
  private readonly zoneSource = new VectorSource<Feature>();
  private readonly marks = new VectorSource<Feature>();
  private readonly tools: ZoneTools;
  private palette: Palette;
  private picture: MapPicture | null = null;
  private path: readonly Point[] = [];
  private dots: readonly Point[] = [];
  private zones: readonly MapZone[] = [];
  /** What was seen after everything was last fitted in. */
  private fitted = "";
  private fittedPlaces: readonly Point[] = [];
  private robot: { place: Point; heading_rad: number | null } | null = null;

  constructor(
    private readonly host: HTMLElement,
    private readonly owner: MapOwner,
  ) {
    this.palette = paletteOf(host);
    this.floor = new FloorLayer(this.palette);
    const layers = [
      this.floor,
      ...[this.ground, this.zoneSource, this.marks].map((source) => new VectorLayer({ source })),
    ];
    const projection = new Projection({
      code: "robot-map",
      units: "m",
      metersPerUnit: 1,
      getPointResolution: (each) => each,
    });
    this.map = new OlMap({
      target: host,
      layers,
      controls: [],
      // The wheel alone scrolls the page that the map is in.
      interactions: usualInteractions({
        altShiftDragRotate: false,
        pinchRotate: false,
        doubleClickZoom: false,
        mouseWheelZoom: false,
      }).extend([new MouseWheelZoom({ condition: platformModifierKeyOnly })]),
      view: new View({
        projection,
        center: [0, 0],
        resolution: 0.05,
        minResolution: 0.0005,
        maxResolution: 50,
        enableRotation: false,
      }),
    });
    const sketch = () => [zoneStyle(this.palette, "draft"), handleStyle(this.palette)];
    this.tools = new ZoneTools(
      this.map,
      this.zoneSource,
      () => this.zones,
      () => this.around(),
      sketch,
      owner,
    );
    this.map.on("pointermove", ({ coordinate: [x = 0, y = 0] }) => owner.pointed?.([x, y]));
    host.addEventListener("pointerleave", () => owner.pointed?.(null));
    this.map.getView().on("change:resolution", () => {
      this.tellScale();
      this.showMarks();
    });
    this.fit();
    this.tellScale();
  }

  setPicture(picture: MapPicture | null): void {
    this.picture = picture;
    this.floor.setPicture(picture, () => this.owner.failed?.());
    this.showZones();
  }

  /** Where the robot went. */
  setPath(path: readonly Point[]): void {
    this.path = path;
    this.showGround();
    this.showZones();
  }

  /** Places worth a dot, such as those of decisions. */
  setDots(dots: readonly Point[]): void {
    this.dots = dots;
    this.showGround();
  }

  setZones(zones: readonly MapZone[]): void {
    const wasEmpty = this.content() === null;
    this.zones = zones;
    this.showZones();
    if (wasEmpty || this.hidesChosen()) this.fit();
  }

  /** Puts the robot somewhere, looking along `heading_rad` (0 is along x, against the clock); null takes it away. */
  setRobot(place: Point | null, heading_rad: number | null = null): void {
    this.robot = place && { place, heading_rad };
    this.showMarks();
  }

  setTool(tool: Tool): void {
    this.tools.use(tool);
  }

  /** Takes back the last corner of the polygon that is being drawn; whether there was one. */
  removeLastCorner(): boolean {
    return this.tools.removeLastCorner();
  }

  /** Fits everything in, or these places and what is around them. */
  fit(places: readonly Point[] = []): void {
    this.map.updateSize();
    const near = extentOf(places);
    const extent = near === null ? (this.content() ?? USUAL_EXTENT) : grown(near, AROUND_M);
    this.map.getView().fit([...extent], { padding: FIT_MARGINS_PX });
    this.fittedPlaces = places;
    this.fitted = this.seen();
  }

  zoom(steps: number): void {
    this.map.getView().adjustZoom(steps);
  }

  /** Draws in the colours that the page has now. */
  applyTheme(): void {
    this.palette = paletteOf(this.host);
    this.floor.setPalette(this.palette);
    this.showGround();
    this.showZones();
    this.showMarks();
  }

  /** The host has another size; who has not moved the map still sees everything. */
  resize(): void {
    if (this.seen() === this.fitted) this.fit(this.fittedPlaces);
    else this.map.updateSize();
  }

  dispose(): void {
    this.map.setTarget(undefined);
    this.map.dispose();
  }

  /** The extent of all that is finite. */
  private content(): Extent | null {
    const corners = this.picture ? cornersOf(this.picture) : [];
    return extentOf([...corners, ...this.path, ...finiteCorners(this.zones.flatMap((zone) => zone.rectangles))]);
  }

  /** Where open sides of zones end on the map. */
  private around(): Extent {
    return widened(this.content() ?? USUAL_EXTENT, 0.25);
  }

  private showGround(): void {
    const features = [];
    if (this.path.length > 1)
      features.push(styled(new LineString(this.path.map((point) => [...point])), pathStyle(this.palette)));
    if (this.dots.length > 0)
      features.push(styled(new MultiPoint(this.dots.map((point) => [...point])), dotStyle(this.palette)));
    this.ground.clear(true);
    this.ground.addFeatures(features);
  }

  private showZones(): void {
    const features = this.zones.flatMap((zone) => {
      const shapes = zone.rectangles.map((rectangle) => fromExtent([...closed(rectangle, null)]));
      const [largest] = [...shapes].sort((a, b) => b.getArea() - a.getArea());
      return shapes.map((shape, index) => {
        const style = zoneStyle(this.palette, zone.tone);
        const feature = styled(shape, shape === largest ? [style, this.labelOf(zone, index)] : style);
        feature.setProperties({ zone: zone.id, rectangle: index });
        return feature;
      });
    });
    this.zoneSource.clear(true);
    this.zoneSource.addFeatures(features);
    this.showMarks();
  }

  /** A zone's name in the middle of what is there, also where its sides are open and far away. */
  private labelOf({ label, rectangles }: MapZone, index: number): Style {
    const style = labelStyle(this.palette, label);
    style.setGeometry((feature) => {
      const shape = (feature as Feature).getGeometry()?.getExtent() ?? [];
      const isBounded = Object.values(rectangles[index] ?? {}).every((side) => side !== null);
      return new OlPoint(getCenter(isBounded ? shape : getIntersection(shape, [...this.around()])));
    });
    return style;
  }

  private showMarks(): void {
    const places = handlesOf(this.zones, this.around(), this.resolution).map(({ place }) => new OlPoint([...place]));
    const handles = places.map((place) => styled(place, handleStyle(this.palette)));
    this.marks.clear(true);
    this.marks.addFeatures(handles);
    if (!this.robot) return;
    const robot = new Feature(new OlPoint([...this.robot.place]));
    robot.setStyle(robotStyle(this.palette, this.robot.heading_rad));
    this.marks.addFeature(robot);
  }

  /** Whether the zone that somebody works on is nowhere to be seen. */
  private hidesChosen(): boolean {
    const seen = this.map.getView().calculateExtent();
    const chosen = this.zones.filter((zone) => zone.tone === "draft" || zone.tone === "selected");
    const rectangles = chosen.flatMap((zone) => zone.rectangles);
    return rectangles.length > 0 && !rectangles.some((each) => intersects([...closed(each, this.around())], seen));
  }

  /** Which part of the world is seen. */
  private seen(): string {
    const view = this.map.getView();
    return `${view.getCenter()} ${view.getResolution()}`;
  }

  /** Metres per pixel. */
  private get resolution(): number {
    return this.map.getView().getResolution() ?? 1;
  }

  private tellScale(): void {
    const metres = niceStep((this.resolution * SCALE_PX) / 2);
    this.owner.scaled?.({ metres, px: metres / this.resolution });
  }
}

function styled(geometry: ConstructorParameters<typeof Feature>[0], style: Style | Style[]): Feature {
  const feature = new Feature(geometry);
  feature.setStyle(style);
  return feature;
}
