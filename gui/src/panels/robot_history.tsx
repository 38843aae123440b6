// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { RobotEvent, RobotHistoryAnswer } from "../api/types";
import { MapCanvas } from "../map/map_canvas";
import type { MapView } from "../map/map_view";
import { duration } from "../state/robot_trouble";
import { ColumnHeads } from "../ui/data_table";
import { useAsked } from "../ui/later";
import { clock } from "../ui/numbers";

const COLUMNS = ["At", "What", "Was", "Became", "Because of"];

/** What the server heard of a robot within the last hour: where it went, and what changed. */
export function RobotHistory({ api, node }: { api: Api; node: string }) {
  const history = useAsked(() => api.ask("POST /api/robot/history", { node }), [node]);
  if (history === null) return null;
  return (
    <section class="robot-history" aria-label="Last hour">
      <h2>Last hour</h2>
      <p class="quiet">{saidOf(history)}</p>
      {history.path.length > 0 && <RobotPath history={history} />}
      {history.events.length > 0 && (
        // biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard scrolls only what it can reach
        <div class="table-scroll" tabIndex={0}>
          <table aria-label="Changes of the last hour">
            <ColumnHeads names={COLUMNS} />
            <tbody>
              {history.events.map((event, index) => (
                <EventRow key={history.events.length - index} event={event} />
              ))}
            </tbody>
          </table>
        </div>
      )}
    </section>
  );
}

function EventRow({ event: { s_ago, name, before, after, because } }: { event: RobotEvent }) {
  return (
    <tr>
      <td>{clock(Date.now() - s_ago * 1000, "medium")}</td>
      <th scope="row">{name}</th>
      <td>{before}</td>
      <td>{after}</td>
      <td>{because}</td>
    </tr>
  );
}

function RobotPath({ history }: { history: RobotHistoryAnswer }) {
  const [view, setView] = useState<MapView | null>(null);
  useEffect(() => {
    if (view === null) return;
    const [, x = 0, y = 0] = history.path.at(-1) ?? [];
    view.setPath(history.path.map(([, ...place]) => place));
    view.setRobot([x, y]);
    // Who looks at a part of the map stays there.
    view.resize();
  }, [view, history]);
  return (
    <div class="robot-path">
      <MapCanvas label="Path of the robot" opened={setView} />
    </div>
  );
}

function saidOf({ since_s_ago, events, left_out, pose_topic }: RobotHistoryAnswer): string {
  const older = left_out > 0 ? `; ${left_out} older changes are left out.` : ".";
  const changes = events.length === 0 ? ", nothing changed." : older;
  const where =
    pose_topic === null ? "No check of its rules reads where it is." : `Its place is what rules read of ${pose_topic}.`;
  return `Heard for ${duration(since_s_ago)}${changes} ${where}`;
}
