// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import * as Blockly from "blockly/core";

/** Lets a finger that swipes over blocks scroll them, as it does elsewhere; it drags the block that it tapped before. */
export function scrollByFinger(host: HTMLElement): void {
  let down: PointerEvent | null = null;
  let tapped: object | null = null;
  const lift = (event: PointerEvent) => {
    if (event.pointerId !== down?.pointerId) return;
    const isTap = Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) <= Blockly.config.dragRadius;
    const touched = Blockly.getSelected();
    // What was dragged can be dragged on.
    if (isTap || touched !== tapped) tapped = isTap ? touched : null;
    down = null;
  };
  const press = (event: PointerEvent) => {
    down = event.pointerType === "touch" ? event : null;
  };
  host.addEventListener("pointerdown", press, { capture: true });
  host.addEventListener("pointerup", lift, { capture: true });
  host.addEventListener("pointercancel", lift, { capture: true });
  for (const definition of Object.values(Blockly.Blocks)) {
    Object.assign(definition, {
      isMovable(this: Blockly.BlockSvg) {
        const isSwiped = down !== null && this !== tapped && !this.isInFlyout;
        return !isSwiped && Blockly.BlockSvg.prototype.isMovable.call(this);
      },
    });
  }
}
