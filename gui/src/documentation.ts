// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Route, readRoute } from "./route";

/** The tab of the documentation, which is asked for once. */
export const DOCUMENTATION_TAB = "ruler-documentation";
const ROOT = "./documentation/";
/** What the documentation has of each page. */
const PLACES: Record<Route["page"], string> = {
  home: "ruler.html",
  rules: "ruler/rules.html",
  topics: "ruler/levels.html",
  robots: "ruler/robot.html#all-robots",
  incidents: "ruler/incidents.html",
  recordings: "ruler/files.html",
  tour: "ruler.html#five-minutes-on-the-page",
};

/** What the documentation has of a page. */
export function documentationHref(page: Route["page"]): string {
  return ROOT + PLACES[page];
}

/** Opens the documentation at `place`, else at what it has of the page that is open. */
export function openDocumentation(place = PLACES[readRoute().page]): void {
  open(ROOT + place, DOCUMENTATION_TAB)?.focus();
}

export const KEYS_PLACE = "ruler/rules.html#keys";

/** Where the documentation says what a finding means. */
export function findingHref(code: string): string {
  return `${ROOT}finding/${encodeURIComponent(code)}`;
}
