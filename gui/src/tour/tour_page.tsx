// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo } from "preact/hooks";
import { EditorPage } from "../pages/editor";
import type { PageProps } from "../pages/page_props";
import { toRoute } from "../route";
import { focusPageSoon } from "../ui/dialog";
import { EXAMPLE_RULES, ExampleApi, exampleEditors, exampleProject } from "./example";
import { TourCard } from "./tour_card";

/** The editor on an example that is in no file, and the tour of it; `rules` is the file that it was called from. */
export function TourPage({ project, refresh, rules, keepings }: PageProps) {
  const own = useMemo(
    () => ({ api: new ExampleApi(), editors: exampleEditors(), project: exampleProject(project) }),
    [],
  );
  useEffect(() => focusPageSoon, []);
  const end = () => toRoute(rules === undefined ? { page: "home", name: "" } : { page: "rules", name: rules });
  return (
    <div class="touring">
      <EditorPage {...own} {...{ refresh, keepings }} name={EXAMPLE_RULES} />
      <TourCard onEnd={end} />
    </div>
  );
}
