// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** Which page the address names. */
export interface Route {
  page: "home" | "rules" | "topics" | "help" | "robots";
  name: string;
  /** The node of the robot that is to be shown beside the rules. */
  robot?: string;
}

const PAGES = new Set(["rules", "topics", "help", "robots"]);

export function readRoute(): Route {
  const [path = "", query = ""] = location.hash.split("?");
  const [, page = "", ...rest] = path.split("/");
  if (!PAGES.has(page)) return { page: "home", name: "" };
  const robot = new URLSearchParams(query).get("robot");
  return { page: page as Route["page"], name: rest.map(decoded).join("/"), ...(robot === null ? {} : { robot }) };
}

export function href(route: Route): string {
  if (route.page === "home") return "#/";
  const robot = route.robot === undefined ? "" : `?robot=${encodeURIComponent(route.robot)}`;
  return `#/${[route.page, ...route.name.split("/").map(encodeURIComponent)].join("/")}${robot}`;
}

export function toRoute(route: Route): void {
  location.hash = href(route);
}

function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}
