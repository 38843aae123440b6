// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useSignalEffect } from "@preact/signals";
import { type ComponentChildren, createContext } from "preact";
import { useContext, useEffect, useId, useState } from "preact/hooks";
import type { RobotLink } from "../state/robot_link";
import { Notice } from "./notice";
import { clock } from "./numbers";

/** Why something cannot be pressed. */
const NEEDS_SERVER = "This needs the Ruler's server, which does not answer now";
const MAY_ONLY_WATCH = "You may only watch here: this would change a file or a robot";

/** Says on every page that the server is gone, and what still works, until it is back. */
export function ServerGone() {
  const link = useRobot();
  const since = link.goneSinceMs.value;
  useSignalEffect(() => {
    document.body.classList.toggle("server-gone", link.goneSinceMs.value !== null);
  });
  if (link.server.value.kind === "other") {
    const reload = { label: "Reload", act: () => location.reload() };
    return <Notice kind="warning" text="The server is another version: this page does not fit it." action={reload} />;
  }
  if (since === null) return null;
  const needsToken = link.server.value.kind === "lost" && link.server.value.needsToken;
  return (
    <div class="notice error server-notice" role="alert">
      <span>
        <strong>
          {needsToken
            ? "The Ruler's server no longer takes this browser's token."
            : `The Ruler's server has not answered since ${clock(since)}.`}
        </strong>{" "}
        You can go on typing in the text and in tables; it is kept in this browser. Blocks, checks, saving, tries and
        robots wait. {needsToken ? <TokenWay /> : <ServerWay />}
      </span>
    </div>
  );
}

const ServerWay = () => (
  <>
    Is <code>testudo ruler</code> still running in its terminal? Once it is, this page goes on by itself.
  </>
);

const TokenWay = () => (
  <>
    <code>testudo ruler</code> was started again and printed another address: open that in another tab of this browser,
    and this page goes on by itself.
  </>
);

/** Says on every page that it may only watch, and what that means. */
export function WatchNotice() {
  if (!useRobot().onlyWatches.value) return null;
  return (
    <div class="watch-notice" role="status">
      <strong>You may only watch here.</strong> No robot and no file is changed; what you try in rules stays in this
      browser. For more, ask whoever started <code>testudo ruler</code>.
    </div>
  );
}

/** Disables its children while the server is gone and, where they change something, on a page that may only watch. */
export function NeedsServer({ changes = false, children }: { changes?: boolean; children: ComponentChildren }) {
  const link = useRobot();
  const whyNot = link.isServerGone.value
    ? NEEDS_SERVER
    : changes && link.onlyWatches.value
      ? MAY_ONLY_WATCH
      : undefined;
  return (
    <fieldset class="needs-server" disabled={whyNot !== undefined} title={whyNot}>
      {children}
    </fieldset>
  );
}

/** Does something each time that the server comes back. */
export function useReturn(act: () => unknown): void {
  const { returns } = useRobot();
  const count = returns.value;
  useEffect(() => {
    if (count > 0) void act();
  }, [count]);
}

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
  const link = useRobot();
  const { kind, words: ownWords, why } = link.connection.value;
  const alarm = link.alarm.value;
  const isFailing = alarm !== "";
  const words = alarm || ownWords;
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
        {words.replace(/ for .*/, "")}
      </p>
    </div>
  );
}
