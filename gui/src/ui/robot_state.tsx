// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { createContext } from "preact";
import { useContext, useId, useState } from "preact/hooks";
import type { RobotLink } from "../state/robot_link";

const RobotContext = createContext<RobotLink | null>(null);
export const RobotProvider = RobotContext.Provider;

/** What the page knows of robots. */
export function useRobot(): RobotLink {
  const link = useContext(RobotContext);
  if (link === null) throw new Error("no RobotProvider around this component");
  return link;
}

const SIGNS = { connected: "●", silent: "◐", none: "○" };

/** Whether a robot is connected, on every page; hovering, focusing or pressing it says why. */
export function RobotState() {
  const id = useId();
  const [isPinned, setPinned] = useState(false);
  const { kind, isFailing, words, why } = useRobot().connection.value;
  return (
    <div class={`robot-state ${isFailing ? "failing" : kind}${isPinned ? " pinned" : ""}`}>
      <button
        type="button"
        class="small"
        aria-label={words}
        aria-describedby={id}
        onClick={() => setPinned(!isPinned)}
        onBlur={() => setPinned(false)}
      >
        <span aria-hidden="true">{isFailing ? "✕" : SIGNS[kind]}</span> <span class="word">{words}</span>
      </button>
      <p role="tooltip" id={id}>
        {why}
      </p>
      <p class="visually-hidden" role="status">
        {kind === "silent" ? "robot silent" : words}
      </p>
    </div>
  );
}
