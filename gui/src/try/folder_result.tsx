// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { TryHeadline } from "../api/types";
import { COLUMNS, type Column, type FolderTrial, MAX_ROWS, sentKbPerS, type TriedRow, totalOf } from "../state/trial";
import { folderWords } from "../state/tries";
import { Button } from "../ui/button";
import { DataTable } from "../ui/data_table";
import { counted, durationWords, percent, readable, sizeWords } from "../ui/numbers";
import { focusIn, showOnNarrow } from "../ui/watch";

const NAMES = Object.keys(COLUMNS) as Column[];
const WORDS = [NAMES.indexOf("loss"), NAMES.indexOf("error")];

/** More problems than these would push the table away. */
const MAX_OPEN = 3;

interface Props {
  trial: FolderTrial;
  isRunning: boolean;
  /** What is another one since the tries began: `rules`, `profile`, `recording`. */
  changed: readonly string[];
  /** The recording whose try was looked at last. */
  opened: string | undefined;
  open: (bag: string) => void;
}

/** The tries on a folder: how many are done, what all of them save, and a row for each, the worst first. */
export function FolderResult({ trial, isRunning, changed, opened, open }: Props) {
  const rows = trial.rows.value;
  const count = trial.recordings.length;
  const result = useRef<HTMLDivElement>(null);
  // Back from a try, nothing has the focus: the button that had it is gone.
  useEffect(() => focusIn(result.current, `tbody button[title="${CSS.escape(opened ?? "")}"]`), []);
  // The progress and what ends it stand above.
  useEffect(() => showOnNarrow(() => result.current?.parentElement ?? null), [trial, rows.length > 0]);
  const failed = trial.problems.value.length;
  const isEnded = !isRunning && trial.done < count;
  return (
    <div class="try-result" ref={result}>
      <p role="status">
        {readable(trial.done)} of {counted(count, "recording")} of {folderWords(trial.folder)} tried
        {failed > 0 && `, ${readable(failed)} without a result`}
        {isEnded && ". The others were not: it was ended before. What was tried stays"}.
      </p>
      <StaleNotice
        changed={changed}
        advice={
          isRunning
            ? "This run goes on with the rules and recordings that it began with."
            : "Run the rules again to see what they do now."
        }
      />
      <ProblemList trial={trial} />
      {rows.length > 0 && <RowTable {...{ trial, open }} />}
    </div>
  );
}

function ProblemList({ trial }: { trial: FolderTrial }) {
  const problems = trial.problems.value;
  if (problems.length === 0) return null;
  const left = problems.length - MAX_ROWS;
  return (
    <details class="notice error column not-tried" open={problems.length <= MAX_OPEN}>
      <summary>{counted(problems.length, "recording")} could not be tried</summary>
      <ul>
        {problems.slice(0, MAX_ROWS).map(({ bag, why }) => (
          <li key={bag}>
            <code>{trial.nameOf(bag)}</code>: {why}
          </li>
        ))}
        {left > 0 && <li>and {readable(left)} more</li>}
      </ul>
    </details>
  );
}

function RowTable({ trial, open }: Pick<Props, "trial" | "open">) {
  const rows = trial.rows.value;
  const [order, shown] = [trial.order.value, trial.shown.value];
  const total = useMemo(() => totalOf(rows), [rows]);
  const sort = (index: number) => {
    const column = NAMES[index] as Column;
    trial.order.value = { column, isDown: column === order.column ? !order.isDown : COLUMNS[column].isDown };
  };
  return (
    <>
      <p class="headline">
        <strong>{percent(total.percent)} % less sent</strong>; {sizeWords(total.after_kb)} in all
      </p>
      {rows.length > shown.length && (
        <p class="quiet">
          The first {shown.length} of {counted(rows.length, "recording")} in this order.
        </p>
      )}
      <div class="table-scroll">
        <DataTable
          label="Recordings"
          class="try-table folder-table"
          heads={NAMES.map((name) => COLUMNS[name].title)}
          words={WORDS}
          sort={{ column: NAMES.indexOf(order.column), isDown: order.isDown, by: sort }}
          keys={shown.map(({ bag }) => bag)}
          rows={shown.map((row) => [
            <RecordingName key={row.bag} {...{ trial, row, open }} />,
            ...cellsOf(row.headline),
          ])}
          foot={[
            `Total of ${counted(rows.length, "recording")}`,
            rateWords(sentKbPerS(total)),
            percent(total.percent),
            "",
            "",
            missedWords(total) || "–",
          ]}
        />
      </div>
    </>
  );
}

function RecordingName({ trial, row, open }: Pick<Props, "trial" | "open"> & { row: TriedRow }) {
  return (
    <>
      <Button label={trial.nameOf(row.bag)} title={row.bag} class="link" onClick={() => open(row.bag)} />
      {row.headline.notices.map((notice) => (
        <small key={notice} class="quiet">
          {notice}
        </small>
      ))}
    </>
  );
}

function cellsOf(headline: TryHeadline): string[] {
  return [
    rateWords(sentKbPerS(headline)),
    percent(headline.percent),
    lossWords(headline) || "nothing",
    errorWords(headline) || "–",
    missedWords(headline) || "–",
  ];
}

function rateWords(kbPerS: number | null): string {
  return kbPerS === null ? "–" : readable(kbPerS);
}

/** What the operator misses most: `/scan: 43 of 3 360, up to 2.9 s old`; empty where every message arrives. */
export function lossWords({ worst_topic: worst }: Pick<TryHeadline, "worst_topic">): string {
  if (worst === null) return "";
  const { topic, sent, received, longest_s, is_image } = worst;
  if (received === 0) return `${topic}: none of ${readable(sent)}`;
  const age = is_image ? `dark for ${durationWords(longest_s)}` : `up to ${durationWords(longest_s)} old`;
  return `${topic}: ${readable(received)} of ${readable(sent)}, ${age}`;
}

/** The RMSE of the worst property: `/odom pose_y: 0.4 m (5.1 %)`, of its range; empty where none was off. */
export function errorWords({ worst_field: worst }: Pick<TryHeadline, "worst_field">): string {
  if (worst === null) return "";
  const { topic, field, unit, rmse, share } = worst;
  const size = [readable(rmse), unit].filter(Boolean).join(" ");
  return `${topic} ${field}: ${size} (${readable(100 * share)} %)`;
}

/** `2 of 14`; empty where no threshold was crossed. */
export function missedWords(headline: Pick<TryHeadline, "crossings" | "missed_crossings">): string {
  const { crossings, missed_crossings } = headline;
  return crossings === 0 ? "" : `${readable(missed_crossings)} of ${readable(crossings)}`;
}

/** Says what changed since a try; nothing where nothing did. */
export function StaleNotice({ changed, advice }: { changed: readonly string[]; advice: string }) {
  if (changed.length === 0) return null;
  return (
    <p class="notice warning" role="status">
      Stale: {andWords(changed)} changed since. {advice}
    </p>
  );
}

/** `rules and recording`. */
function andWords(words: readonly string[]): string {
  return [words.slice(0, -1).join(", "), ...words.slice(-1)].filter(Boolean).join(" and ");
}
