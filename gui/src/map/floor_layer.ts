// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import Layer from "ol/layer/Layer";
import type { FrameState } from "ol/Map";
import type { Palette } from "./palette";
import type { MapPicture } from "./shapes";

const LINE_GAP_PX = 56;
const LABEL_MARGIN_PX = 4;

/** What lies below everything: a picture of the floor, however it is turned, and a grid in metres. */
export class FloorLayer extends Layer {
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
export function niceStep(least: number): number {
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
