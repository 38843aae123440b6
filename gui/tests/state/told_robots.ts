// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { vi } from "vitest";
import { PROTOCOL_VERSION, type RobotSummary, type RulesInForce } from "../../src/api/types";
import { RobotLink } from "../../src/state/robot_link";
import { storage } from "./served";

const RULES: RulesInForce = { files: [], sha256: "old", origin: "files", waits_s: null };

/** A robot that is heard, and follows its files unless `rules` say otherwise. */
export function robotOf(node: string, rules: Partial<RulesInForce> = {}, isHeard = true): RobotSummary {
  return {
    ...{ node, label: node, is_heard: isHeard, heard_s_ago: 0, topics: 1, rules: { ...RULES, ...rules } },
    ...{ budget_kb_per_s: null, out_kb_per_s: 0, link: null, health: null, recorded: 0 },
  };
}

/** A page's link to its server, which greeted and told of these robots. */
export function linkOf(...robots: RobotSummary[]): RobotLink {
  vi.stubGlobal("localStorage", storage());
  vi.stubGlobal("WebSocket", { OPEN: 1 });
  const link = new RobotLink();
  link.onPush({ kind: "hello", version: "1", protocol: PROTOCOL_VERSION, only_watches: false });
  tell(link, ...robots);
  return link;
}

export function tell(link: RobotLink, ...robots: RobotSummary[]): void {
  link.onPush({ kind: "robots", problem: null, robots });
}
