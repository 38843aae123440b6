// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Live } from "../api/types";
import { linkWords } from "../state/robot_trouble";
import { fixed, readable } from "../ui/numbers";

/** What all topics take of the link together, and what the runtime takes of its machine. */
export function RobotTotals({ live: { status, status_kb_per_s, accepted, recording } }: { live: Live }) {
  const sent = status.out_kb_per_s;
  const budget = status.budget_kb_per_s;
  const [shown, leftOut] = [status.blocks.length, status.blocks_left_out ?? 0];
  return (
    <dl class="robot-totals">
      <div class={budget !== null && sent > budget ? "over wide" : "wide"}>
        <dt>Sent</dt>
        <dd>
          <strong>{readable(sent)}</strong>{" "}
          {budget === null
            ? "KB/s, no budget set"
            : `of ${readable(budget)} KB/s (${readable((100 * sent) / budget)} %)`}
        </dd>
        {budget !== null && (
          <meter min={0} max={1} value={Math.min(sent / budget, 1)} aria-label="Sent: share of the budget" />
        )}
      </div>
      {status.link && <Figure name="Link" value={linkWords(status.link)} />}
      {Object.entries(status.accepted ?? {}).map(([topic, { problem }], place) => (
        <Figure key={topic} name={`Accepts ${topic}`} value={accepted[place] ?? ""} isTroubled={problem !== null} />
      ))}
      {recording !== null && (
        <Figure name="Records" value={recording} isTroubled={typeof status.incidents?.problem === "string"} />
      )}
      <Figure name="Watching" value={`up to ${readable(status_kb_per_s)} KB/s`} />
      <Figure name="Received" value={`${readable(status.in_kb_per_s)} KB/s`} />
      {leftOut > 0 && <Figure name="Rules shown" value={`${shown} of ${shown + leftOut}`} />}
      <Figure name="CPU" value={status.cpu_percent === null ? "–" : `${fixed(status.cpu_percent, 1)} %`} />
      <Figure name="Memory" value={status.memory_mb === null ? "–" : `${fixed(status.memory_mb, 0)} MB`} />
    </dl>
  );
}

function Figure({ name, value, isTroubled }: { name: string; value: string; isTroubled?: boolean }) {
  return (
    <div class={isTroubled ? "trouble" : ""}>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}
