// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { Api, ApiError } from "../../src/api/client";
import { CheckQueue } from "../../src/state/check_queue";
import { brokenOff, openRules, serve } from "./served";

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

test("an answer that breaks off is one that did not come", async () => {
  serve({ "GET /api/project": brokenOff });
  const failed: unknown = await new Api().project().catch((error: unknown) => error);
  expect(failed).toBeInstanceOf(ApiError);
  expect((failed as ApiError).status).toBe(0);
});

test("a request that is ended while its answer is read was ended, and not refused", async () => {
  const control = new AbortController();
  const ended = () => new Response(new ReadableStream({ pull: (body) => body.error(control.signal.reason) }));
  vi.stubGlobal("fetch", async () => ended());
  control.abort();
  const asked = new Api().ask("GET /api/project", null, { signal: control.signal });
  await expect(asked).rejects.toBe(control.signal.reason);
});

test("after an answer that broke off, rules are checked and saved as before", async () => {
  const disk = { text: "begin\nend\n" };
  const read: string[] = [];
  const editor = await openRules(disk, {
    "POST /api/document": ({ text = "" }) => {
      read.push(text);
      return text.includes("two") ? brokenOff() : { collections: [], findings: [], parses: true };
    },
  });
  editor.type("begin\n// two\nend\n");
  await editor.check();
  expect(editor.message.value).toContain("does not answer");
  editor.type("begin\n// three\nend\n");
  await editor.save();
  await editor.check();
  expect([disk.text, editor.isSaved.value, read.at(-1)]).toEqual([editor.text.value, true, editor.text.value]);
});

test("a save that met a bug costs no later one", async () => {
  const disk = { text: "begin\nend\n" };
  const editor = await openRules(disk);
  await expect(editor.inTurn(() => Promise.reject(new TypeError("a bug")))).rejects.toThrow("a bug");
  editor.type("begin\n// three\nend\n");
  await editor.save();
  await editor.check();
  expect(disk.text).toBe("begin\n// three\nend\n");
});

test("a check that met a bug costs no later one", async () => {
  vi.stubGlobal("window", globalThis);
  const rules = { text: "one", name: "a.adirf", profile_text: null };
  const asked: string[] = [];
  const queue = new CheckQueue(
    () => ({ ...rules }),
    async ({ text }) => {
      asked.push(text);
      if (text === "one") throw new TypeError("a bug");
    },
  );
  await expect(queue.check()).rejects.toThrow("a bug");
  rules.text = "two";
  await queue.check();
  expect(asked).toEqual(["one", "two"]);
});
