// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type ReadonlySignal, useSignal } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { RobotCheck, RobotChecksAnswer, RobotCheckValues, RobotEvent, RobotHistoryAnswer } from "../api/types";
import { duration } from "../state/robot_trouble";
import { holdsWords, Timeline, truthAt } from "../state/timeline";
import { TimeAxis } from "../try/axis";
import { CheckChart, OtherThreshold, RuleLanes } from "../try/check_chart";
import { PathMap } from "../try/path_map";
import { Choice } from "../ui/choice";
import { ColumnHeads } from "../ui/data_table";
import { useAnswer } from "../ui/later";
import { clock, durationWords } from "../ui/numbers";

/** How often the server is asked what it heard of a robot. */
const ASK_EVERY_MS = 2000;
const WINDOWS_S = [600, 3600] as const;

/** Writes another threshold of a check into the rules that are open. */
export type Propose = (check: RobotCheck, threshold: number) => void;

interface Props {
  api: Api;
  node: string;
  /** Null where no rules are open that the robot follows. */
  propose: Propose | null;
}

/** What a robot did in its last minutes, and what changed in its last hour. */
export function RobotPast({ api, node, propose }: Props) {
  const ask = () => api.ask("POST /api/robot/history", { node });
  const { answer: history } = useAnswer(ask, [node], { of: node, everyMs: ASK_EVERY_MS });
  if (history === null) return null;
  return (
    <>
      <Course {...{ api, node, propose, history }} />
      <Changes history={history} />
    </>
  );
}

/** When each rule of a robot held, and beside that where it was; for one of its checks the value and its threshold. */
function Course({ api, node, propose, history }: Props & { history: RobotHistoryAnswer }) {
  const [windowS, setWindow] = useState<number>(WINDOWS_S[0]);
  const [chosen, setChosen] = useState<string>("");
  const [number, setNumber] = useState<number | null>(null);
  const { answer } = useAnswer(
    () => api.ask("POST /api/robot/checks", { node, window_s: windowS, check: number }),
    [node, windowS, number],
    { of: node, everyMs: ASK_EVERY_MS },
  );
  const path = usePath(history, windowS);
  const timeline = useMemo(() => nowAtTheEnd(windowS, path), [windowS]);
  const checks = answer?.checks ?? [];
  // Other rules number their checks anew.
  const found = checks.findIndex((check) => titleOf(check) === chosen);
  useEffect(() => setNumber(found < 0 ? null : found), [found]);
  const hasPath = path.value.length > 0;
  if (answer === null || (answer.rules.length === 0 && !hasPath)) return null;
  const one = checks[found];
  const agoS = windowS - timeline.time.value;
  const said = agoS < 1 ? "now" : clockOf(-agoS);
  const map = <PathMap {...{ timeline }} path={path.value} dotsS={NONE} dotsAre={`by ${history.pose_topic}`} isLive />;
  return (
    <section class="robot-checks" aria-label="Rules and checks over time">
      <div class="row">
        <h2>Rules and checks over time</h2>
        <Choice
          label="Shown"
          value={windowS}
          choices={WINDOWS_S.map((seconds) => [seconds, `last ${durationWords(seconds)}`] as const)}
          choose={setWindow}
        />
      </div>
      <TimeAxis
        timeline={timeline}
        label="Time of the robot"
        words={said}
        said={said}
        ticksS={history.events.map(({ s_ago }) => windowS - s_ago).filter((timeS) => timeS >= 0)}
        beside={hasPath && map}
      >
        <RuleLanes
          title={`Rules ${said === "now" ? said : `at ${said}`}, and when they held`}
          rules={answer.rules.map(({ rule, line, turns }) => {
            return { rule, line, turns, truth: truthAt(turns, timeline.time.value), decides: [] };
          })}
          timeline={timeline}
          show={null}
        />
        {checks.length > 0 && (
          <Choice
            label="Value and threshold of"
            value={chosen}
            choices={[["", "Choose a check"], ...new Set(checks.map(titleOf))]}
            choose={setChosen}
          />
        )}
        {one && answer.values?.check === found && (
          <CheckValues key={chosen} {...{ one, timeline, propose }} values={answer.values} answer={answer} />
        )}
      </TimeAxis>
    </section>
  );
}

/** Where the robot was on a time that ends now. */
function usePath(history: RobotHistoryAnswer, windowS: number): ReadonlySignal<Path> {
  const path = useSignal<Path>([]);
  useEffect(() => {
    const known = history.path.map(([agoS, x, y]) => [windowS - agoS, x, y] as const);
    path.value = known.filter(([timeS]) => timeS >= 0);
  }, [history, windowS]);
  return path;
}

const EVENT_COLUMNS = ["At", "What", "Was", "Became", "Because of"];

/** What changed within the last hour, the newest first. */
function Changes({ history }: { history: RobotHistoryAnswer }) {
  return (
    <section class="robot-history" aria-label="Last hour">
      <h2>Last hour</h2>
      <p class="quiet">{saidOf(history)}</p>
      {history.events.length > 0 && (
        // biome-ignore lint/a11y/noNoninteractiveTabindex: the keyboard scrolls only what it can reach
        <div class="table-scroll" tabIndex={0}>
          <table aria-label="Changes of the last hour">
            <ColumnHeads names={EVENT_COLUMNS} />
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

function saidOf({ since_s_ago, events, left_out, pose_topic }: RobotHistoryAnswer): string {
  const older = left_out > 0 ? `; ${left_out} older changes are left out.` : ".";
  const changes = events.length === 0 ? ", nothing changed." : older;
  const where =
    pose_topic === null ? "No check of its rules reads where it is." : `Its place is what rules read of ${pose_topic}.`;
  return `Heard for ${duration(since_s_ago)}${changes} ${where}`;
}

interface ValuesProps {
  one: RobotCheck;
  values: RobotCheckValues;
  answer: RobotChecksAnswer;
  timeline: Timeline;
  propose: Propose | null;
}

function CheckValues({ one, values, answer, timeline, propose }: ValuesProps) {
  const { limit } = one;
  const threshold = useSignal(typeof limit === "number" ? limit : 0);
  return (
    <div>
      <CheckChart
        {...{ timeline, values, threshold, compared: limit }}
        isFixed={propose === null}
        timeWords={clockOf}
        label={`Value of ${one.topic} ${one.property}, threshold ${limit}`}
        bars={[{ label: "The check", turns: values.turns }]}
        isBusy={false}
      >
        <strong>{wordsOf(one)}</strong>{" "}
        {typeof limit === "number" && (
          <span class="quiet">
            {propose === null ? "The red line is the threshold." : "Drag the red line to propose another threshold."}
          </span>
        )}
      </CheckChart>
      <p role="status">
        {one.op} {limit}: {holdsWords(values.turns, answer.window_s)}, as the robot decided.
      </p>
      {propose !== null && typeof limit === "number" && (
        <OtherThreshold threshold={threshold} written={limit} write={(value) => propose(one, value)} />
      )}
    </div>
  );
}

function wordsOf({ topic, property, op, limit }: RobotCheck): string {
  return `${topic} ${property} ${op} ${limit}`;
}

function titleOf(check: RobotCheck): string {
  return `${wordsOf(check)} (${check.rule})`;
}

type Path = readonly (readonly [timeS: number, x: number, y: number])[];
const NONE: readonly number[] = [];

/** A time that ends now, which is 0 on its charts; where the robot was in it becomes known as time goes on. */
function nowAtTheEnd(windowS: number, path: ReadonlySignal<Path>): Timeline {
  const course = {
    duration_s: windowS,
    bin_s: windowS,
    first_bin_s: 0,
    get path() {
      return path.value;
    },
  };
  return new Timeline(course, 1, windowS, []);
}

/** The hour and minute of so many seconds from now. */
function clockOf(seconds: number): string {
  return clock(Date.now() + 1000 * seconds);
}
