// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type ComponentChildren, createContext } from "preact";
import { useContext, useEffect, useId, useLayoutEffect, useRef, useState } from "preact/hooks";
import { KEYS_PLACE, openDocumentation } from "../documentation";
import { Icon, type IconName } from "./button";
import { RobotState } from "./connection";
import { Breakable } from "./notice";

interface Props {
  title: string;
  /** The state of what is open. */
  note?: string;
  /** Entries of the menu, above those that every page has. */
  menu?: ComponentChildren;
  /** Whether the page begins here: the first Tab then leads to what is before it. */
  isStart?: boolean;
  children?: ComponentChildren;
}

/** The bar on top of every page: what is open, how robots do, and what can be done. */
export function Header({ title, note, menu, isStart = false, children }: Props) {
  const heading = useRef<HTMLHeadingElement>(null);
  useEffect(() => {
    // What had the focus went with the page before.
    if (!isStart && document.activeElement === document.body) heading.current?.focus();
  }, []);
  return (
    <header class="bar">
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
          <MenuItem label="Keys" icon="keys" act={() => openDocumentation(KEYS_PLACE)} />
        </MenuButton>
      </div>
    </header>
  );
}

const CloseContext = createContext<() => void>(() => undefined);
const ITEMS = '[role="menuitem"]:not(:disabled)';
const MOVES: Readonly<Record<string, (at: number, last: number) => number>> = {
  ArrowDown: (at, last) => (at >= last ? 0 : at + 1),
  ArrowUp: (at, last) => (at <= 0 ? last : at - 1),
  Home: () => 0,
  End: (_, last) => last,
};

/** A button that opens a menu, as the ARIA Authoring Practices describe it; its children are `MenuItem`s. */
export function MenuButton({ label, icon, children }: { label: string; icon: IconName; children: ComponentChildren }) {
  const id = useId();
  /** The end of the menu that is pointed at when it opens; null while it is closed. */
  const [opened, setOpened] = useState<"first" | "last" | null>(null);
  const button = useRef<HTMLButtonElement>(null);
  const menu = useRef<HTMLDivElement>(null);
  const items = () => [...(menu.current?.querySelectorAll<HTMLElement>(ITEMS) ?? [])];
  useLayoutEffect(() => {
    if (opened !== null)
      items()
        .at(opened === "first" ? 0 : -1)
        ?.focus();
  }, [opened]);
  const close = () => {
    setOpened(null);
    button.current?.focus();
  };
  const press = (event: KeyboardEvent) => {
    if (event.key === "Tab") return setOpened(null);
    const all = items();
    const at = all.indexOf(document.activeElement as HTMLElement);
    const next = MOVES[event.key]?.(at, all.length - 1) ?? startingWith(event, all, at);
    if (event.key === "Escape") close();
    else if (next === null) return;
    else all[next]?.focus();
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <div
      class="menu-button"
      onFocusOut={(event) => {
        if (!event.currentTarget.contains(event.relatedTarget as Node | null)) setOpened(null);
      }}
    >
      <button
        type="button"
        ref={button}
        title={label}
        aria-haspopup="menu"
        aria-expanded={opened !== null}
        aria-controls={opened === null ? undefined : id}
        onClick={() => setOpened(opened === null ? "first" : null)}
        onKeyDown={(event) => {
          if (event.key !== "ArrowDown" && event.key !== "ArrowUp") return;
          event.preventDefault();
          setOpened(event.key === "ArrowDown" ? "first" : "last");
        }}
      >
        <Icon name={icon} />
        <span class="word">{label}</span>
      </button>
      {opened !== null && (
        <div class="menu" role="menu" id={id} aria-label={label} ref={menu} onKeyDown={press}>
          <CloseContext.Provider value={close}>{children}</CloseContext.Provider>
        </div>
      )}
    </div>
  );
}

/** The next item, from the one at `at` on, whose words begin with the letter that is pressed. */
function startingWith(event: KeyboardEvent, items: readonly HTMLElement[], at: number): number | null {
  if (event.key.length !== 1 || event.key === " " || event.ctrlKey || event.metaKey || event.altKey) return null;
  const letter = event.key.toLowerCase();
  const begins = (item: HTMLElement) => item.innerText.trim().toLowerCase().startsWith(letter);
  const after = items.findIndex((item, index) => index > at && begins(item));
  const found = after >= 0 ? after : items.findIndex(begins);
  return found >= 0 ? found : null;
}

interface ItemProps {
  label: string;
  icon?: IconName;
  isDisabled?: boolean;
  /** The keys that do the same. */
  keys?: string;
  act: () => void;
}

/** A line of a menu; it gives the focus back to the menu's button before it acts. */
export function MenuItem({ label, icon, isDisabled = false, keys, act }: ItemProps) {
  const close = useContext(CloseContext);
  return (
    <button
      type="button"
      role="menuitem"
      tabIndex={-1}
      aria-keyshortcuts={keys}
      disabled={isDisabled}
      onClick={() => {
        close();
        act();
      }}
    >
      {icon && <Icon name={icon} />}
      <span>{label}</span>
      {keys && (
        <span class="keys" aria-hidden="true">
          {keys}
        </span>
      )}
    </button>
  );
}
