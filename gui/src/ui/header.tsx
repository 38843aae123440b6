// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { href } from "../route";
import { RobotState } from "./robot_state";

/** The bar on top of every page but the first: the way home, what is open, and what can be done with it. */
export function Header({ title, note, children }: { title: string; note?: string; children?: ComponentChildren }) {
  const heading = useRef<HTMLHeadingElement>(null);
  useEffect(() => {
    // What had the focus went with the page before.
    if (document.activeElement === document.body) heading.current?.focus();
  }, []);
  return (
    <header class="bar">
      <a class="home-link" href={href({ page: "home", name: "" })} aria-label="Home">
        <img src="./icon.svg" alt="" width="26" height="26" />
      </a>
      <h1 title={title} tabIndex={-1} ref={heading}>
        {title}
      </h1>
      {note !== undefined && <span class="quiet">{note}</span>}
      <RobotState />
      <div class="bar-tools" role="toolbar" aria-label="Tools">
        {children}
      </div>
    </header>
  );
}
