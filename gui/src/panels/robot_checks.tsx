// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useSignal } from "@preact/signals";
import { useEffect, useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { RobotCheck, RobotChecksAnswer, RobotCheckValues } from "../api/types";
import { holdsWords, Timeline, truthAt } from "../state/timeline";
import { TimeAxis } from "../try/axis";
import { CheckChart, OtherThreshold, RuleLanes } from "../try/check_chart";
import { Choice } from "../ui/choice";
import { useAnswer } from "../ui/later";
import { clock, durationWords } from "../ui/numbers";
import { ASK_EVERY_MS } from "./robot_view";

const WINDOWS_S = [600, 3600] as const;

/** Writes another threshold of a check into the rules that are open. */
export type Propose = (check: RobotCheck, threshold: number) => void;

interface Props {
  api: Api;
  node: string;
  /** Null where no rules are open that the robot follows. */
  propose: Propose | null;
}

/** When each rule of a robot held in its last minutes, and for one of its checks the value and its threshold. */
export function RobotChecks({ api, node, propose }: Props) {
  const [windowS, setWindow] = useState<number>(WINDOWS_S[0]);
  const [chosen, setChosen] = useState<string>("");
  const [number, setNumber] = useState<number | null>(null);
  const { answer } = useAnswer(
    () => api.ask("POST /api/robot/checks", { node, window_s: windowS, check: number }),
    [node, windowS, number],
    { of: node, everyMs: ASK_EVERY_MS },
  );
  const timeline = useMemo(() => nowAtTheEnd(windowS), [windowS]);
  const checks = answer?.checks ?? [];
  // Other rules number their checks anew.
  const found = checks.findIndex((check) => titleOf(check) === chosen);
  useEffect(() => setNumber(found < 0 ? null : found), [found]);
  if (answer === null || answer.rules.length === 0) return null;
  const one = checks[found];
  const agoS = windowS - timeline.time.value;
  const said = agoS < 1 ? "now" : clockOf(-agoS);
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
      <TimeAxis timeline={timeline} label="Time of the robot" words={said} said={said}>
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

/** A time that ends now, which is 0 on its charts. */
function nowAtTheEnd(windowS: number): Timeline {
  return new Timeline({ duration_s: windowS, bin_s: windowS, first_bin_s: 0, path: [] }, 1, windowS, []);
}

/** The hour and minute of so many seconds from now. */
function clockOf(seconds: number): string {
  return clock(Date.now() + 1000 * seconds);
}
