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
import Layer from "ol/layer/Layer";
import VectorLayer from "ol/layer/Vector";
import type { FrameState } from "ol/Map";
import OlMap from "ol/Map";
import Projection from "ol/proj/Projection";
import VectorSource from "ol/source/Vector";
import type Style from "ol/style/Style";
import View from "ol/View";
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
import { handlesOf, ZoneTools } from "./zone_tools";

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
      this.showScale();
      this.showMarks();
    });
    this.fit();
    this.showScale();
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

  /** Follows another size of the host; a map that nobody moved still shows everything. */
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

  private showScale(): void {
    const metres = niceStep((this.resolution * SCALE_PX) / 2);
    this.owner.scaled?.({ metres, px: metres / this.resolution });
  }
}

function styled(geometry: ConstructorParameters<typeof Feature>[0], style: Style | Style[]): Feature {
  const feature = new Feature(geometry);
  feature.setStyle(style);
  return feature;
}

const LINE_GAP_PX = 56;
const LABEL_MARGIN_PX = 4;

/** What lies below everything: a picture of the floor, however it is turned, and a grid in metres. */
class FloorLayer extends Layer {
  private readonly canvas = document.createElement("canvas");
  private picture: MapPicture | null = null;
  private drawable: CanvasImageSource | null = null;

  constructor(private palette: Palette) {
    super({ render: (frame) => (frame ? this.draw(frame) : this.canvas) });
    this.canvas.style.cssText = "position:absolute;inset:0;width:100%;height:100%";
  }

  /** Shows a picture once it is loaded; `failed` is called where it cannot be. */
  setPicture(picture: MapPicture | null, failed: () => void): void {
    this.picture = picture;
    this.drawable = null;
    this.changed();
    if (picture === null) return;
    const image = new Image();
    image.onload = () => {
      if (this.picture !== picture) return;
      this.drawable = picture.is_stencil ? stencil(image, this.palette.text) : image;
      this.changed();
    };
    image.onerror = () => this.picture === picture && failed();
    image.src = picture.url;
  }

  setPalette(palette: Palette): void {
    this.palette = palette;
    this.setPicture(this.picture, () => undefined);
  }

  private draw(frame: FrameState): HTMLCanvasElement {
    const { canvas } = this;
    const [width = 0, height = 0] = frame.size;
    canvas.width = Math.round(width * frame.pixelRatio);
    canvas.height = Math.round(height * frame.pixelRatio);
    const context = canvas.getContext("2d");
    if (!context) return canvas;
    context.scale(frame.pixelRatio, frame.pixelRatio);
    this.drawPicture(context, frame);
    this.drawGrid(context, frame);
    return canvas;
  }

  private drawPicture(context: CanvasRenderingContext2D, frame: FrameState): void {
    if (!this.drawable || !this.picture) return;
    const { x, y, width_m, height_m, yaw_rad } = this.picture;
    const [left, top] = toPixel(frame, x, y);
    const scale = 1 / frame.viewState.resolution;
    context.save();
    context.translate(left, top);
    context.rotate(-yaw_rad);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.drawable, 0, -height_m * scale, width_m * scale, height_m * scale);
    context.restore();
  }

  private drawGrid(context: CanvasRenderingContext2D, frame: FrameState): void {
    const [width = 0, height = 0] = frame.size;
    const step = niceStep(frame.viewState.resolution * LINE_GAP_PX);
    context.font = `11px ${this.palette.font}`;
    const [left = 0, low = 0, right = 0, high = 0] = frame.extent ?? [];
    for (const x of multiples(step, left, right)) {
      const [at] = toPixel(frame, x, 0);
      this.line(context, x === 0, [at, 0, at, height]);
      this.label(context, shown(x, step), at + LABEL_MARGIN_PX, height - LABEL_MARGIN_PX);
    }
    for (const y of multiples(step, low, high)) {
      const [, at] = toPixel(frame, 0, y);
      this.line(context, y === 0, [0, at, width, at]);
      this.label(context, shown(y, step), LABEL_MARGIN_PX, at - LABEL_MARGIN_PX);
    }
  }

  private label(context: CanvasRenderingContext2D, words: string, x: number, y: number): void {
    // Walls have the colour of text: an edge parts the number from them.
    context.strokeStyle = this.palette.surface;
    context.lineWidth = 3;
    context.lineJoin = "round";
    context.strokeText(words, x, y);
    context.fillStyle = this.palette.text;
    context.fillText(words, x, y);
  }

  private line(context: CanvasRenderingContext2D, isAxis: boolean, ends: [number, number, number, number]): void {
    context.strokeStyle = isAxis ? this.palette.lineStrong : this.palette.line;
    context.lineWidth = isAxis ? 1.5 : 1;
    context.beginPath();
    context.moveTo(ends[0], ends[1]);
    context.lineTo(ends[2], ends[3]);
    context.stroke();
  }
}

/** The round step (1, 2 or 5 of a power of ten) next above `least`. */
function niceStep(least: number): number {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((digit) => digit * power).find((step) => step >= least) ?? 10 * power;
}

function* multiples(step: number, from: number, to: number): Generator<number> {
  for (let count = Math.ceil(from / step); count * step <= to; count++) yield count * step;
}

function shown(value: number, step: number): string {
  return value.toFixed(Math.max(0, -Math.floor(Math.log10(step))));
}

function toPixel(frame: FrameState, x: number, y: number): [number, number] {
  const [a = 1, b = 0, c = 0, d = 1, e = 0, f = 0] = frame.coordinateToPixelTransform;
  return [a * x + c * y + e, b * x + d * y + f];
}

/** `image` with every colour replaced by one. */
function stencil(image: HTMLImageElement, colour: string): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = image.naturalWidth;
  canvas.height = image.naturalHeight;
  const context = canvas.getContext("2d");
  if (context) {
    context.drawImage(image, 0, 0);
    context.globalCompositeOperation = "source-in";
    context.fillStyle = colour;
    context.fillRect(0, 0, canvas.width, canvas.height);
  }
  return canvas;
}
