// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import type { ComponentChildren } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { href } from "../route";
import { Breakable } from "./breakable";
import { later } from "./later";
import { MenuButton, MenuItem } from "./menu_button";
import { RobotState } from "./robot_state";
import { useWindowEvent } from "./watch";

const DocumentationPanel = later(async () => (await import("../documentation/documentation_panel")).DocumentationPanel);

interface Props {
  title: string;
  /** The state of what is open. */
  note?: string;
  /** Entries of the menu, above those that every page has. */
  menu?: ComponentChildren;
  children?: ComponentChildren;
}

/** The bar on top of every page but the first: the way home, what is open, and what can be done with it. */
export function Header({ title, note, menu, children }: Props) {
  const heading = useRef<HTMLHeadingElement>(null);
  /** The place of the documentation that is shown beside the page, null for none. */
  const [help, setHelp] = useState<string | null>(null);
  useEffect(() => {
    // What had the focus went with the page before.
    if (document.activeElement === document.body) heading.current?.focus();
  }, []);
  useHelpKey(() => setHelp(""));
  return (
    <header class="bar">
      <a class="home-link" href={href({ page: "home", name: "" })} aria-label="Home" title="Home">
        <img src="./icon.svg" alt="" width="26" height="26" />
      </a>
      <div class="bar-title">
        <h1 title={title} tabIndex={-1} ref={heading}>
          <Breakable name={title} />
        </h1>
        {note !== undefined && (
          <span class="quiet" title={note}>
            {note}
          </span>
        )}
      </div>
      <RobotState />
      <div class="bar-tools" role="toolbar" aria-label="Tools">
        {children}
        <MenuButton label="Menu" icon="menu">
          {menu}
          <MenuItem label="Documentation" icon="book" keys="F1" act={() => setHelp("")} />
          <MenuItem label="Keys" icon="keys" act={() => setHelp("keys")} />
        </MenuButton>
      </div>
      {help !== null && <DocumentationPanel key={help} anchor={help} onClose={() => setHelp(null)} />}
    </header>
  );
}

function useHelpKey(open: () => void): void {
  useWindowEvent("keydown", (event) => {
    if (event.key !== "F1") return;
    event.preventDefault();
    open();
  });
}
