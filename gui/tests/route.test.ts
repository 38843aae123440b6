// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { href, readRoute } from "../src/route";

/** Node has no address bar. */
function address(hash: string): void {
  vi.stubGlobal("location", new URL(hash, "http://127.0.0.1/"));
}

afterEach(() => vi.unstubAllGlobals());

test.each([
  { page: "home", name: "" },
  { page: "rules", name: "warehouse.adirf" },
  { page: "rules", name: "night shift/50 %/#1?.adirf" },
  { page: "topics", name: "prüfstand.toml" },
  { page: "robots", name: "" },
  { page: "robots", name: "/tb3_0/smarttestudo" },
  { page: "topics", name: "a.toml", rules: "night shift/a&b.adirf" },
  { page: "rules", name: "what?/a&b.adirf", robot: "/tb3 0/smart?testudo" },
] as const)("the link to $page $name leads there", (route) => {
  address(href(route));
  expect(readRoute()).toEqual(route);
});

test.each(["", "#", "#/", "#/settings/x", "#rules"])("the address %j is the first page", (hash) => {
  address(hash);
  expect(readRoute()).toEqual({ page: "home", name: "" });
});

test("a name that somebody typed with a bare percent sign is taken as it stands", () => {
  address("#/rules/50%.adirf");
  expect(readRoute()).toEqual({ page: "rules", name: "50%.adirf" });
});
