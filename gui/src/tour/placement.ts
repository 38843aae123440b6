// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** A part of the window, in CSS pixels. */
export interface Box {
  left: number;
  top: number;
  width: number;
  height: number;
}

export interface Size {
  width: number;
  height: number;
}

const GAP_PX = 14;
const NARROW_PX = 600;

/**
 * Where a card goes that points at `part`: beside it, below or above, where it fits whole, else into its lower right
 * corner; on a telephone at the foot of the window.
 */
export function placed(part: Box, card: Size, view: Size): { left: number; top: number } {
  const foot = view.height - card.height - GAP_PX;
  if (view.width <= NARROW_PX) return { left: (view.width - card.width) / 2, top: foot };
  const [right, bottom] = [part.left + part.width, part.top + part.height];
  const within = (wanted: number, most: number) => Math.max(GAP_PX, Math.min(wanted, most));
  const left = within(part.left, view.width - card.width - GAP_PX);
  const top = within(part.top + GAP_PX, foot);
  const beside = [
    { left: right + GAP_PX, top },
    { left: part.left - card.width - GAP_PX, top },
  ];
  const belowOrAbove = [
    { left, top: bottom + GAP_PX },
    { left, top: part.top - card.height - GAP_PX },
  ];
  // Beside a bar the card would cover its neighbours.
  const choices = part.height < card.height ? [...belowOrAbove, ...beside] : [...beside, ...belowOrAbove];
  const fits = (at: { left: number; top: number }) =>
    at.left >= 0 && at.top >= 0 && at.left + card.width <= view.width && at.top + card.height <= view.height;
  return (
    choices.find(fits) ?? {
      left: within(right - card.width - GAP_PX, view.width - card.width - GAP_PX),
      top: within(bottom - card.height - GAP_PX, foot),
    }
  );
}

/** The part of `box` that is inside the window. */
export function shownPart(box: Box, view: Size): Box {
  const left = Math.max(0, box.left);
  const top = Math.max(0, box.top);
  const width = Math.max(0, Math.min(view.width, box.left + box.width) - left);
  const height = Math.max(0, Math.min(view.height, box.top + box.height) - top);
  return { left, top, width, height };
}
