// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import type { FullScreen } from "../state/room";
import { Button } from "./button";

interface Props<Part extends string> {
  full: FullScreen<Part>;
  part: Part;
  /** What the part is called, for those who do not see it. */
  what: string;
}

/** Gives a part of the page all of it, and takes it back. */
export function FullScreenButton<Part extends string>({ full, part, what }: Props<Part>) {
  const isFull = full.part.value === part;
  const label = isFull ? "Leave full screen" : "Full screen";
  return (
    <Button
      label={label}
      class="small full-screen-button"
      aria-label={`${label}: ${what}`}
      onClick={() => full.toggle(part)}
    />
  );
}
