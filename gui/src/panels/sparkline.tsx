// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { type RateRing, RING_LENGTH, type RobotLink } from "../state/robot_link";

const WIDTH_PX = 120;
const HEIGHT_PX = 24;

/** The actual rate of a topic over the last seconds, drawn with the next picture that the screen shows. */
export function Sparkline({ link, topic }: { link: RobotLink; topic: string }) {
  const host = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const context = host.current?.getContext("2d");
    if (!context) return;
    const scale = devicePixelRatio;
    context.canvas.width = WIDTH_PX * scale;
    context.canvas.height = HEIGHT_PX * scale;
    context.setTransform(scale, 0, 0, scale, 0, 0);
    let frame = 0;
    const stop = effect(() => {
      void link.samples.value;
      cancelAnimationFrame(frame);
      frame = requestAnimationFrame(() => draw(context, link.rates.of(topic)));
    });
    return () => {
      stop();
      cancelAnimationFrame(frame);
    };
  }, [topic]);
  // biome-ignore lint/a11y/noAriaHiddenOnFocusable: the keyboard does not reach a canvas without tabIndex
  return <canvas ref={host} class="sparkline" aria-hidden="true" />;
}

function draw(context: CanvasRenderingContext2D, ring: RateRing): void {
  const highest = ring.highest();
  context.clearRect(0, 0, WIDTH_PX, HEIGHT_PX);
  // The style sheet's colour of the canvas, which follows the light or dark setting.
  context.strokeStyle = getComputedStyle(context.canvas).color;
  context.lineWidth = 1.5;
  context.beginPath();
  let isDown = false;
  for (let age = 0; age < RING_LENGTH; age++) {
    const rate = ring.at(age);
    const [x, y] = [(age / (RING_LENGTH - 1)) * WIDTH_PX, HEIGHT_PX - 2 - (rate / highest) * (HEIGHT_PX - 4)];
    if (Number.isNaN(rate)) isDown = false;
    else if (isDown) context.lineTo(x, y);
    else {
      context.moveTo(x, y);
      isDown = true;
    }
  }
  context.stroke();
}
