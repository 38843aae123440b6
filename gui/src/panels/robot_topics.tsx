// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useMemo } from "preact/hooks";
import type { Live, LiveTopic } from "../api/types";
import type { RobotLink } from "../state/robot_link";
import { readable } from "../ui/numbers";
import { Sparkline } from "./sparkline";

/** Every relayed topic of a robot as it is now. */
export function RobotTopics({ link, live }: { link: RobotLink; live: Live }) {
  return (
    <div class="table-scroll">
      <table class="robot-topics" aria-label="Topics of the robot">
        <thead>
          <tr>
            <th scope="col">Topic</th>
            <th scope="col">Source (Hz)</th>
            <th scope="col">Target (Hz)</th>
            <th scope="col">Actual (Hz)</th>
            <th scope="col">Actual, last 48 s</th>
            <th scope="col">Sent (KB/s)</th>
            <th scope="col">Decided by</th>
            <th scope="col">State</th>
          </tr>
        </thead>
        <tbody>
          {live.topics.map((topic) => (
            <TopicRow key={topic.topic} link={link} topic={topic.topic} cells={cellsOf(topic)} />
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** What the row of a topic says, in the order of the columns, and how it looks; the sparkline is beside it. */
function cellsOf(topic: LiveTopic): string {
  const rate = (hz: number | null) => (hz === null ? "–" : hz.toFixed(1));
  const target = topic.target_hz === null ? "Full" : readable(topic.target_hz);
  return [
    rate(topic.source_hz),
    target,
    rate(topic.actual_hz),
    topic.out_kb_per_s.toFixed(1),
    topic.rule ?? REASONS[topic.reason] ?? topic.reason,
    topic.problem ?? topic.silence ?? relayed(topic),
    (topic.problem ?? topic.silence) ? "silent" : "",
  ].join("\n");
}

function relayed({ keeps_rate, error_percent }: LiveTopic): string {
  if (keeps_rate || error_percent === null) return "relayed";
  return `rate off by ${error_percent.toFixed(0).replace("-", "−")} %`;
}

const REASONS: Record<string, string> = {
  default: "default",
  unknown: "unknown values",
  floor: "floor",
  budget: "budget",
  fallback: "no valid rules",
  reload: "new rules",
};

/** One row; `cells` is one text, so that a row in which nothing changed is left alone. */
function TopicRow({ link, topic, cells }: { link: RobotLink; topic: string; cells: string }) {
  return useMemo(() => {
    const [source, target, actual, sent, decider, state, look] = cells.split("\n");
    return (
      <tr class={look}>
        <th scope="row">{topic}</th>
        <td class="number">{source}</td>
        <td class="number">{target}</td>
        <td class="number">{actual}</td>
        <td>
          <Sparkline link={link} topic={topic} />
        </td>
        <td class="number">{sent}</td>
        <td>{decider}</td>
        <td>{state}</td>
      </tr>
    );
  }, [topic, cells]);
}
