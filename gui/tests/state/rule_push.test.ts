// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { afterEach, expect, test, vi } from "vitest";
import { RulePush } from "../../src/state/robot_rules";
import { openRules } from "./served";
import { linkOf, robotOf, tell } from "./told_robots";

afterEach(() => vi.unstubAllGlobals());

/** Rules that are open beside two robots, and which texts were compared with a robot's and sent to it. */
async function pushing(disk = { text: "begin\nend\n" }) {
  const compared: string[] = [];
  const sent: string[] = [];
  const editor = await openRules(disk, {
    "POST /api/push/preview": ({ text = "" }) => {
      compared.push(text);
      return { same: false, differences: [], hash: "new", robot_hash: "old", text_to_send: text };
    },
    "POST /api/push": ({ text = "" }) => {
      sent.push(text);
      return { state: "waiting", hash: "new", confirm_within_s: 30 };
    },
    "POST /api/push/confirm": () => ({}),
  });
  const link = linkOf(robotOf("/ada"), robotOf("/bob"));
  const push = new RulePush(editor, link);
  push.follow();
  return { editor, link, push, compared, sent };
}

/** The same, where the first robot tries the rules for four more seconds. */
async function trying() {
  const pushed = await pushing();
  await pushed.push.ask();
  await pushed.push.send();
  tell(pushed.link, robotOf("/ada", { sha256: "new", origin: "waiting", waits_s: 4 }), robotOf("/bob"));
  return pushed;
}

test("what is sent is what was compared, though the file is read again behind the dialog", async () => {
  const disk = { text: "begin\nend\n" };
  const { editor, push, compared, sent } = await pushing(disk);
  await push.ask();
  disk.text = "begin\n// theirs\nend\n";
  await editor.lookAtDisk();
  expect(editor.text.value).toBe(disk.text);
  await push.send();
  expect([compared, sent]).toEqual([["begin\nend\n"], ["begin\nend\n"]]);
});

test("the time that is left of a try is that on its robot, whichever is chosen", async () => {
  const { link, push } = await trying();
  expect(push.leftS.value).toBe(4);
  link.choose("/bob");
  expect(push.leftS.value).toBe(4);
});

test("to send again while a robot tries the rules leaves the way to keep them", async () => {
  const { push, compared } = await trying();
  await push.ask();
  expect([push.stage.value.kind, compared.length]).toEqual(["trying", 1]);
  await push.keep();
  expect(push.stage.value.kind).toBe("kept");
});

test("other rules can be sent once a try was given up, or its robot is not heard", async () => {
  const { link, push } = await trying();
  push.letGo();
  await push.ask();
  expect(push.stage.value.kind).toBe("asked");
  push.stage.value = { kind: "trying", node: "/ada", hash: "new", withinS: 30, isSeen: true, isLetGo: false };
  tell(link, robotOf("/ada", { sha256: "new", origin: "waiting", waits_s: 4 }, false), robotOf("/bob"));
  link.choose("/bob");
  await push.ask();
  expect(push.stage.value).toMatchObject({ kind: "asked", node: "/bob" });
});
