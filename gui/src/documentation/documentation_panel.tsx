// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";
import { Button } from "../ui/button";
import { DocumentationReader } from "./reader";

const HELP = "#/help/";

/** The documentation beside what is open, which stays as it is; `anchor` is the place to show first. */
export function DocumentationPanel(props: { anchor: string; onClose: () => void }) {
  const [anchor, setAnchor] = useState(props.anchor);
  const panel = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    const opener = document.activeElement;
    panel.current?.show();
    return () => {
      if (opener instanceof HTMLElement && opener.isConnected) opener.focus();
    };
  }, []);
  const follow = (event: MouseEvent) => {
    const link = event.target instanceof Element ? event.target.closest("a") : null;
    const target = link?.getAttribute("href") ?? "";
    if (!target.startsWith(HELP) || event.ctrlKey || event.metaKey || event.shiftKey) return;
    event.preventDefault();
    const name = decodeURIComponent(target.slice(HELP.length));
    if (name === anchor) document.getElementById(name)?.scrollIntoView();
    setAnchor(name);
  };
  return (
    <dialog
      ref={panel}
      class="documentation"
      aria-label="Documentation"
      onClickCapture={follow}
      onKeyDown={(event) => event.key === "Escape" && props.onClose()}
    >
      <div class="row documentation-bar">
        <h2>Documentation</h2>
        <a href={`${HELP}${anchor}`} target="_blank" rel="noreferrer">
          On a page of its own
        </a>
        <Button label="Close" class="small" title="Close (Escape)" onClick={props.onClose} />
      </div>
      <DocumentationReader anchor={anchor} isSearchFirst />
    </dialog>
  );
}
