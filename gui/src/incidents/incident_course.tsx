// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useMemo } from "preact/hooks";
import type { IncidentCourse, TopicRates } from "../api/types";
import { Timeline } from "../state/timeline";
import { PathMap } from "../try/path_map";
import { Scrubber } from "../try/scrubber";
import { Strip } from "../try/strip";
import { Button } from "../ui/button";
import { Notes } from "../ui/notice";
import { readable } from "../ui/numbers";
import { sinceMoment } from "./missing_words";
import type { Ground } from "./rule_ground";

/** What happened around the moment of an incident: one slider for the path and the rates of all topics. */
export function CourseView({ course, ground }: { course: IncidentCourse; ground: Ground }) {
  const timeline = useMemo(() => timelineOf(course), [course]);
  const now = sinceMoment(timeline.time.value - course.trigger_s);
  const dotsS = useMemo(() => [course.trigger_s], [course]);
  return (
    <section class="incident-course" aria-label="Around the moment">
      <h2>Around the moment</h2>
      <Notes notes={course.notices} />
      <Scrubber
        timeline={timeline}
        label="Time around the moment (s)"
        words={now}
        said={now}
        ticksS={NONE}
        after={
          <Button
            label="To the moment"
            class="small"
            disabled={now === "the moment"}
            onClick={() => timeline.goTo(course.trigger_s)}
          />
        }
      />
      <div class={course.path.length > 1 ? "try-columns" : ""}>
        {course.path.length > 1 && (
          <PathMap
            timeline={timeline}
            path={course.path}
            dotsS={dotsS}
            dotsAre="The dot is the moment."
            picture={ground.picture.value}
            zones={ground.zones.value}
            isNear
          />
        )}
        <section class="try-column" aria-label="Rates">
          <h3>Messages a second (Hz); 0 s is the moment</h3>
          {course.topics.map((topic) => (
            <TopicStrip key={topic.topic} {...{ timeline, topic }} />
          ))}
        </section>
      </div>
    </section>
  );
}

const NONE: readonly number[] = [];

/** The time of an incident: charts count from its moment, where the slider is at first. */
function timelineOf(course: IncidentCourse): Timeline {
  const { trigger_s, topics } = course;
  return new Timeline(course, topics[0]?.hz_bins.length ?? 0, trigger_s, [trigger_s]);
}

function TopicStrip({ timeline, topic }: { timeline: Timeline; topic: TopicRates }) {
  const lines = useMemo(() => ({ after: topic.hz_bins }), [topic]);
  const now = topic.hz_bins[timeline.bin.value] ?? null;
  return (
    <Strip timeline={timeline} lines={lines} label={`Rate of ${topic.topic}`}>
      <strong>{topic.topic}</strong> <span class="quiet">{now === null ? "" : `${readable(now)} Hz`}</span>
    </Strip>
  );
}
