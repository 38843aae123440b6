// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { ComponentType } from "preact";
import { useEffect, useState } from "preact/hooks";
import { href, NEW_PROFILE, type Route } from "../route";
import type { PageProps } from "./page_props";

interface Props {
  Page: ComponentType<PageProps>;
  route: Route;
  props: PageProps;
  onMissing: (name: string) => void;
}

/** The page of a file that is there, or of none; the address of one that is not there leads home. */
export function KnownFile({ Page, route, props, onMissing }: Props) {
  const [isThere, setIsThere] = useState(mayBeNew(route, props));
  useEffect(() => {
    if (isThere) return;
    props.api.fileState(route.name).then(
      ({ hash }) => {
        if (hash !== null) return setIsThere(true);
        onMissing(route.name);
        location.replace(href({ page: "home", name: "" }));
      },
      // The page says itself why a file cannot be read.
      () => setIsThere(true),
    );
  }, []);
  return isThere ? <Page {...props} /> : <p class="quiet center">Loading …</p>;
}

/** Whether the page of the address shows no file, one that is known, or a table that begins with it. */
function mayBeNew({ page, name, rules }: Route, { project, editors }: PageProps): boolean {
  if (page !== "rules" && page !== "topics") return true;
  const isKnown = (kind: "rules" | "profile") =>
    editors.unsaved(kind).includes(name) || project.files.some((file) => file.kind === kind && file.name === name);
  if (page === "rules") return isKnown("rules");
  return isKnown("profile") || rules !== undefined || name === NEW_PROFILE;
}
