// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

/** Which page the address names. */
export interface Route {
  page: "home" | "rules" | "topics" | "help";
  name: string;
}

const PAGES = new Set(["rules", "topics", "help"]);

export function readRoute(): Route {
  const [, page = "", ...rest] = location.hash.split("/");
  if (!PAGES.has(page)) return { page: "home", name: "" };
  return { page: page as Route["page"], name: rest.map(decoded).join("/") };
}

export function href(route: Route): string {
  if (route.page === "home") return "#/";
  return `#/${[route.page, ...route.name.split("/").map(encodeURIComponent)].join("/")}`;
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
