// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Live } from "../api/types";
import { linkWords } from "../state/robot_trouble";
import { fixed, readable } from "../ui/numbers";

/** What all topics take of the link together, and what the runtime takes of its machine. */
export function RobotTotals({ live }: { live: Live }) {
  const sent = live.out_kb_per_s;
  const heard = live.topics.reduce((sum, topic) => sum + topic.in_kb_per_s, 0);
  const budget = live.budget_kb_per_s;
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
      {live.link && <Figure name="Link" value={linkWords(live.link)} />}
      <Figure name="Watching" value={`up to ${readable(live.status_kb_per_s)} KB/s`} />
      <Figure name="Received" value={`${readable(heard)} KB/s`} />
      {live.blocks_left_out > 0 && (
        <Figure name="Rules shown" value={`${live.blocks.length} of ${live.blocks.length + live.blocks_left_out}`} />
      )}
      <Figure name="CPU" value={live.cpu_percent === null ? "–" : `${fixed(live.cpu_percent, 1)} %`} />
      <Figure name="Memory" value={live.memory_mb === null ? "–" : `${fixed(live.memory_mb, 0)} MB`} />
    </dl>
  );
}

function Figure({ name, value }: { name: string; value: string }) {
  return (
    <div>
      <dt>{name}</dt>
      <dd>{value}</dd>
    </div>
  );
}
