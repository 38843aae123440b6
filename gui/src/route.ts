// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** Which page the address names. */
export interface Route {
  page: "home" | "rules" | "topics" | "robots" | "incidents" | "recordings" | "tour";
  name: string;
  /** The node of the robot that is to be shown beside the rules. */
  robot?: string;
  /** The rule file that the topic parameters are opened for, or that the tour leads back to. */
  rules?: string;
  /** The line of the rule file that is to be shown. */
  line?: string;
}

/** What an address may say besides the page and its file. */
const BESIDES = ["robot", "rules", "line"] as const;
/** What a table of topic parameters is called before somebody names it. */
export const NEW_PROFILE = "profile.toml";
const PAGES = new Set(["rules", "topics", "robots", "incidents", "recordings", "tour"]);

export function readRoute(): Route {
  const [path = "", query = ""] = location.hash.split("?");
  const [, page = "", ...rest] = path.split("/");
  if (!PAGES.has(page)) return { page: "home", name: "" };
  const asked = new URLSearchParams(query);
  const besides = BESIDES.flatMap((key) => (asked.has(key) ? [[key, asked.get(key)]] : []));
  return { page: page as Route["page"], name: rest.map(decoded).join("/"), ...Object.fromEntries(besides) };
}

export function href(route: Route): string {
  if (route.page === "home") return "#/";
  const besides = BESIDES.flatMap((key) => {
    const value = route[key];
    return value === undefined ? [] : [`${key}=${encodeURIComponent(value)}`];
  });
  const query = besides.length === 0 ? "" : `?${besides.join("&")}`;
  return `#/${[route.page, ...route.name.split("/").map(encodeURIComponent)].join("/")}${query}`;
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
