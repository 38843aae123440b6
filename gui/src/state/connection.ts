// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { RobotSummary, Robots, RulesOrigin } from "../api/types";
import { sentence } from "../ui/numbers";

/** The server tells of robots every two seconds; what is so old is no longer trusted. */
export const TOLD_WITHIN_S = 8;

/** Whether the server's web socket is open, and speaks what this page understands. */
export type ServerState =
  | { kind: "lost"; needsToken: boolean }
  | { kind: "opening" }
  | { kind: "open" }
  | { kind: "other"; version: string };

/** What the top of every page says of the robot: few words, and why in full. */
interface Connection {
  kind: "connected" | "silent" | "none";
  /** Whether the robot is heard and does not do what it should. */
  isFailing: boolean;
  words: string;
  why: string;
  /** What a robot that is heard does not do as it should, as a sentence; empty where all is well. */
  trouble: string;
}

/** Sums up what is known; `sinceToldS` is how old `robots` is. */
export function connectionOf(
  server: ServerState,
  robots: Robots | null,
  node: string | null,
  sinceToldS: number,
): Connection {
  if (server.kind === "lost") {
    const why = server.needsToken ? "no longer takes this browser's token" : "does not answer";
    return none(`The Ruler's server ${why}. The page reconnects by itself.`);
  }
  if (server.kind === "other") {
    return none(
      `The server is SmartTestudo ${server.version}, which needs another version of this page. Reload the page.`,
    );
  }
  if (server.kind === "opening" || robots === null) return none("Waiting for the server's list of robots.");
  const robot = robots.robots.find((each) => each.node === node);
  if (robots.problem !== null && !robot) return none(robots.problem);
  if (!robot) return none("No robot found. Start 'testudo run' on the robot, in the ROS domain of this server.");
  return heardFrom(robot, sinceToldS);
}

function heardFrom(robot: RobotSummary, sinceToldS: number): Connection {
  const silentS = Math.floor(robot.heard_s_ago + sinceToldS);
  if (robot.is_heard && sinceToldS < TOLD_WITHIN_S) {
    const { health, label } = robot;
    const isFailing = health?.level === "error";
    const rules = RULES_WORDS[robot.rules.origin];
    const hasRules = robot.rules.origin !== "fallback";
    const trouble = hasRules && health ? `${sentence(health.message)}.` : "";
    return {
      kind: "connected",
      isFailing,
      words: isFailing ? `${label}: ${health.summary}` : `connected to ${robot.node}`,
      why: `${robot.node} relays ${robot.topics} topics. ${rules}${trouble && ` ${trouble}`}`,
      trouble: hasRules ? trouble : rules,
    };
  }
  return {
    kind: "silent",
    isFailing: false,
    words: `robot silent for ${silentS} s`,
    why: `No status of ${robot.node} for ${silentS} s. Check that 'testudo run' is running and the radio is up.`,
    trouble: "",
  };
}

function none(why: string): Connection {
  return { kind: "none", isFailing: false, words: "not connected", why, trouble: "" };
}

/** Which rules a robot follows, as a sentence. */
export const RULES_WORDS: Record<RulesOrigin, string> = {
  files: "It follows the rule files on its disk.",
  pushed: "It follows rules that were sent to it.",
  waiting: "It is trying rules that were sent to it, and reverts them unless they are kept.",
  fallback: "It has no valid rules. Mend its rule files, or send it rules.",
};
