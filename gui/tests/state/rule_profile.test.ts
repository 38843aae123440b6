// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { Api } from "../../src/api/client";
import { RuleProfile } from "../../src/state/rule_editor";
import { type Disk, fileAnswers, serve } from "./served";

const RULES = { text: "begin end", name: "far.adirf", profile_text: null };
afterEach(() => vi.unstubAllGlobals());

/** Remembers `lte.toml` for the rules in place of one that is gone; a file is read when the test says so. */
function server(): Map<string, () => void> {
  const reads = new Map<string, () => void>();
  vi.stubGlobal("fetch", (path: string) => {
    const answer = (body: object) => new Response(JSON.stringify(body));
    const { pathname, searchParams } = new URL(path, "http://localhost");
    if (pathname === "/api/profile/for") return Promise.resolve(answer({ name: "lte.toml", gone: "old.toml" }));
    const name = searchParams.get("name") ?? "";
    return new Promise((resolve) => reads.set(name, () => resolve(answer({ name, text: "" }))));
  });
  return reads;
}

test("a profile that is gone is named beside the one in its place", async () => {
  const reads = server();
  const profile = new RuleProfile(new Api());
  const recalled = profile.recall(RULES);
  await vi.waitFor(() => expect(reads.has("lte.toml")).toBe(true));
  reads.get("lte.toml")?.();
  await recalled;
  expect([profile.used.value?.name, profile.gone.value, profile.isKnown.value]).toEqual(["lte.toml", "old.toml", true]);
});

test("a profile that was known is not while it is asked again which one goes with the rules", async () => {
  const reads = server();
  const profile = new RuleProfile(new Api());
  const chosen = profile.use("wifi.toml");
  await vi.waitFor(() => expect(reads.has("wifi.toml")).toBe(true));
  reads.get("wifi.toml")?.();
  await chosen;
  const recalled = profile.recall(RULES);
  expect(profile.isKnown.value).toBe(false);
  await vi.waitFor(() => expect(reads.has("lte.toml")).toBe(true));
  reads.get("lte.toml")?.();
  await recalled;
  expect([profile.used.value?.name, profile.isKnown.value]).toEqual(["lte.toml", true]);
});

test("who chooses another profile while the likeliest is read is told of none that is gone", async () => {
  const reads = server();
  const profile = new RuleProfile(new Api());
  const recalled = profile.recall(RULES);
  await vi.waitFor(() => expect(reads.has("lte.toml")).toBe(true));
  const chosen = profile.use("wifi.toml");
  await vi.waitFor(() => expect(reads.has("wifi.toml")).toBe(true));
  for (const read of reads.values()) read();
  await Promise.all([recalled, chosen]);
  expect([profile.used.value?.name, profile.gone.value, profile.isKnown.value]).toEqual(["wifi.toml", null, true]);
});

test("a profile that is gone is still named once the server is there again", async () => {
  const reads = server();
  const profile = new RuleProfile(new Api());
  for (const work of [() => profile.recall(RULES), () => profile.revive()]) {
    reads.clear();
    const done = work();
    await vi.waitFor(() => expect(reads.has("lte.toml")).toBe(true));
    reads.get("lte.toml")?.();
    await done;
    expect(profile.gone.value).toBe("old.toml");
  }
});

test("a profile that changes on disk is read again, and one that goes has another in its place", async () => {
  const disk: Disk = { text: "budget_kb_per_s = 1" };
  const other: Disk = { text: "budget_kb_per_s = 3" };
  serve({
    ...fileAnswers("lte.toml", disk),
    "GET /api/file": (asked) =>
      fileAnswers(asked.name ?? "", asked.name === "lte.toml" ? disk : other)["GET /api/file"]?.(asked),
    "POST /api/profile/for": () => ({ name: "wifi.toml", gone: "lte.toml" }),
  });
  const profile = new RuleProfile(new Api());
  await profile.use("lte.toml");
  expect(await profile.lookAtDisk(RULES)).toBe(false);
  disk.text = "budget_kb_per_s = 2";
  expect([await profile.lookAtDisk(RULES), profile.used.value?.text]).toEqual([true, "budget_kb_per_s = 2"]);
  disk.text = null;
  expect(await profile.lookAtDisk(RULES)).toBe(true);
  expect([profile.used.value?.name, profile.gone.value]).toEqual(["wifi.toml", "lte.toml"]);
});
