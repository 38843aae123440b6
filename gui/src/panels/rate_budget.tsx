// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal, useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { type Rules, refusal } from "../api/client";
import type { OptimizeAnswer, Project, Refusal, Repair, SituationLoad } from "../api/types";
import { withoutLines } from "../blocks/rule_words";
import { href } from "../route";
import type { ProfileRepair } from "../state/profile_repair";
import type { RuleEditor } from "../state/rule_editor";
import { namesLevel, topicsIn } from "../state/statements";
import { Button } from "../ui/button";
import { NeedsServer } from "../ui/connection";
import { FormDialog } from "../ui/dialog";
import { baseName, download } from "../ui/files";
import { hz, kilobytes, readable, sentence } from "../ui/numbers";
import { ProfileChangeNotice, ProfileChoice } from "./profile_choice";

const AFTER_MS = 300;
/** Findings on a profile that does not say what rates need. */
const LACKING: ReadonlySet<string> = new Set(["profile-incomplete", "budget-not-proven"]);
/** Recordings that are offered to measure in. */
const MOST_BAGS = 3;

interface Props {
  editor: RuleEditor;
  project: Project;
  repair: ProfileRepair;
  /** Whether the rates are to be downloaded as soon as they are known. */
  wantsRates: Signal<boolean>;
}

/**
 * How much of the budget the rules take where they take most; a press says what each topic takes, and how all would
 * fit. What is to be downloaded and is not known is said there, too.
 */
export function RateBudget({ editor, project, repair, wantsRates }: Props) {
  const rates = useSignal<Optimized | null>(null);
  /** Whether the details are open, and whether that is to download the rates. */
  const opened = useSignal<"closed" | "to look" | "to download">("closed");
  const close = () => (opened.value = "closed");
  useEffect(() => followRates(editor, rates, () => wantsRates.value || opened.value !== "closed"), []);
  const result = rates.value;
  const profile = editor.profile.value;
  const isAnswered = editor.profileChoice.isKnown.value && (profile === null || isOfNow(result, editor));
  const known = isAnswered && result !== null && "download_text" in result ? result.download_text : null;
  useEffect(() => {
    if (!wantsRates.value || !isAnswered) return;
    const open = () => (opened.value = "to download");
    if (profile === null) void downloadPlain(editor, open);
    else if (known === null) open();
    else download(ratesName(editor), known);
    wantsRates.value = false;
  }, [wantsRates.value, isAnswered]);
  const isToDownload = opened.value === "to download";
  const submit = () => {
    if (isToDownload && known !== null) download(ratesName(editor), known);
    close();
  };
  return (
    <>
      <BudgetBar {...{ editor, result }} onOpen={() => (opened.value = "to look")} />
      {opened.value !== "closed" && (
        <FormDialog
          title="Rates within the budget"
          submit={isToDownload ? "Download" : "Close"}
          isNotice={!isToDownload}
          canSubmit={!isToDownload || known !== null}
          isWide
          onSubmit={submit}
          onClose={close}
        >
          {isToDownload && known === null && <p>Nothing was downloaded yet.</p>}
          <NeedsServer>
            <RateDetails {...{ editor, project, repair, result }} />
          </NeedsServer>
        </FormDialog>
      )}
    </>
  );
}

/**
 * Computes rates anew whenever the rules stand still for a moment, until the returned function is called.
 * What would be refused is asked for only if `wantsAnyway`, whose reader is told why.
 */
function followRates(editor: RuleEditor, rates: Signal<Optimized | null>, wantsAnyway: () => boolean): () => void {
  let timer: number | undefined;
  const stop = effect(() => {
    void editor.text.value;
    window.clearTimeout(timer);
    const can = canCompute(editor);
    const known = rates.peek();
    // What was asked for anyway stays true of the same rules.
    if (editor.profile.value === null || (can === false && !wantsAnyway()))
      rates.value = isOfNow(known, editor) ? known : null;
    else if (can || wantsAnyway())
      timer = window.setTimeout(() => void optimized(editor, (answer) => (rates.value = answer)), AFTER_MS);
  });
  return () => {
    stop();
    window.clearTimeout(timer);
  };
}

/** Whether an answer is of the rules and the profile that are here. */
function isOfNow(answer: Optimized | null, { text, profile }: RuleEditor): boolean {
  return answer?.text === text.value && answer.profile_text === profile.value?.text;
}

/** Whether the rules have no errors, and their profile all that rates need; null while nobody knows. */
function canCompute({ errors, profile, surroundings }: RuleEditor): boolean | null {
  if (errors.value.length > 0 || !/^\s*budget_kb_per_s\s*=/m.test(profile.value?.text ?? "")) return false;
  if (!surroundings.isKnown.value) return null;
  return !surroundings.findings.value.some(({ code }) => LACKING.has(code));
}

/** A bar as full as the budget is where the rules take most of it. */
function BudgetBar(props: { editor: RuleEditor; result: Optimized | null; onOpen: () => void }) {
  const { editor, result, onOpen } = props;
  const situations = result !== null && "situations" in result ? result.situations : [];
  const byLoad = [...situations].sort((one, other) => other.kb_per_s - one.kb_per_s);
  const most = byLoad.find(({ kind }) => kind === "worst") ?? byLoad[0];
  const title = "What each topic takes, and what would make it fit";
  if (result === null || !("situations" in result) || most === undefined) {
    return <Button label="Budget …" class="budget-bar" title={title} onClick={onOpen} />;
  }
  const where = withoutLines(most.title, editor.statements.value);
  const share = most.kb_per_s / result.budget_kb_per_s;
  return (
    <button
      type="button"
      class={result.feasible && share <= 1 ? "budget-bar" : "budget-bar over"}
      title={title}
      style={{ "--share": `${Math.min(100 * share, 100)}%` }}
      onClick={onOpen}
    >
      <span class="where">{where}: </span>
      {kilobytes(most.kb_per_s)} of {kilobytes(result.budget_kb_per_s)} KB/s
    </button>
  );
}

/** Quality levels as rates within the budget, or what is missing for that. */
function RateDetails({ editor, project, repair, result }: Omit<Props, "wantsRates"> & { result: Optimized | null }) {
  const profile = editor.profile.value;
  if (profile === null) {
    return (
      <>
        <p>Choose topic parameters, which say what messages take and levels mean, or create them.</p>
        <ProfileChoice {...{ editor, project }} />
      </>
    );
  }
  if (result === null) return <p class="quiet">Computing rates …</p>;
  if ("refused" in result) {
    return (
      <>
        <p class="problem">{result.refused}.</p>
        <MissingEntries {...{ editor, project, repair }} profile={profile.name} />
        <ProfileChangeNotice repair={repair} />
      </>
    );
  }
  return (
    <div class="optimize">
      <ProfileChangeNotice repair={repair} />
      <p role="status">
        {result.feasible ? "Everything fits into" : "Not everything fits into"}{" "}
        <strong>{kilobytes(result.budget_kb_per_s)} KB/s</strong>.
      </p>
      <RepairAll editor={editor} refusals={result.refusals} text={result.text} />
      {result.refusals.map((refusal) => (
        <RefusalCard key={refusal.rule ?? "defaults"} {...{ editor, refusal }} profiles={repair} text={result.text} />
      ))}
      <div class="situations">
        {toldOnce(result.situations).map((situation) => (
          <SituationBars
            key={`${situation.kind} ${situation.title}`}
            situation={situation}
            budgetKbPerS={result.budget_kb_per_s}
          />
        ))}
      </div>
    </div>
  );
}

/** The situations without a worst one that is that of the only rule. */
function toldOnce(situations: readonly SituationLoad[]): readonly SituationLoad[] {
  const rules = situations.filter(({ kind }) => kind === "rule");
  const isRule = (worst: SituationLoad) => rules.length === 1 && worst.rules[0] === rules[0]?.rules[0];
  return situations.filter((each) => each.kind !== "worst" || !isRule(each));
}

/** The ways to what the topic parameters lack: a recording may say it, or somebody types it. */
function MissingEntries(props: Pick<Props, "editor" | "project" | "repair"> & { profile: string }) {
  const { editor, project, repair, profile } = props;
  const bags = project.files.filter((file) => file.kind === "bag").map((file) => file.name);
  const measure = (bag: string) =>
    void editor.attempt(() => repair.measureMissing(bag, topicsIn(editor.document.value)));
  return (
    <div class="row">
      <NeedsServer changes>
        {bags.slice(0, MOST_BAGS).map((bag) => (
          <Button label={`Measure it in ${bag}`} key={bag} class="small fix" onClick={() => measure(bag)} />
        ))}
      </NeedsServer>
      <a href={href({ page: "topics", name: profile, rules: editor.name })}>Enter it in {profile}</a>
    </div>
  );
}

/** What a rule file with numbers instead of levels is called. */
function ratesName(editor: RuleEditor): string {
  return baseName(editor.name).replace(/\.adirf$/, "-rates.adirf");
}

/** Downloads rules without a profile as they are, unless they name levels, which only a profile makes numbers. */
async function downloadPlain(editor: RuleEditor, open: () => void): Promise<void> {
  const isSound = await editor.isSound();
  // A level without a profile is an error as well: the details say what to do about it.
  if (namesLevel(editor.document.value)) open();
  else if (!isSound) editor.message.value = "Nothing was downloaded: the rules have errors";
  else {
    download(ratesName(editor), editor.text.value);
    editor.message.value = "Downloaded the rules as they are: they name no quality level";
  }
}

/** The smallest change of each part that does not fit, all as one step of undo. */
function RepairAll({ editor, refusals, text }: { editor: RuleEditor; refusals: readonly Refusal[]; text: string }) {
  const repairs = refusals.flatMap(({ repairs }) => repairs.find((each) => each.budget_kb_per_s === null) ?? []);
  if (refusals.length < 2 || repairs.length < refusals.length) return null;
  // The last place comes first, so that each edit finds its place after those before it.
  const edits = repairs.flatMap((each) => each.edits).sort((one, other) => other.offset - one.offset);
  return (
    <Button
      label={`Repair all ${repairs.length}`}
      class="small fix"
      title={repairs.map(({ sentence }) => sentence).join("; ")}
      onClick={() => void editor.repair(text, { edits })}
    />
  );
}

interface RefusalProps {
  editor: RuleEditor;
  profiles: ProfileRepair;
  refusal: Refusal;
  /** What the optimizer refused. */
  text: string;
}

function RefusalCard({ editor, profiles, refusal, text }: RefusalProps) {
  const apply = (repair: Repair) =>
    repair.budget_kb_per_s === null ? editor.repair(text, repair) : profiles.setBudget(repair.budget_kb_per_s);
  return (
    <div class="notice warning column" role="alert">
      <p>{sentence(refusal.message)}</p>
      <div class="row">
        {refusal.repairs.map((repair) => (
          <NeedsServer changes={repair.budget_kb_per_s !== null} key={repair.sentence}>
            <Button
              label={repair.title}
              class="small repair"
              title={repair.sentence}
              onClick={() => void apply(repair)}
            />
          </NeedsServer>
        ))}
      </div>
    </div>
  );
}

/** What each topic takes of the link in one situation, as shares of the budget. */
function SituationBars({ situation, budgetKbPerS }: { situation: SituationLoad; budgetKbPerS: number }) {
  const loads = [...situation.loads].sort((a, b) => b.kb_per_s - a.kb_per_s);
  const share = situation.kb_per_s / budgetKbPerS;
  const scale = Math.max(budgetKbPerS, situation.kb_per_s);
  return (
    <figure class={share > 1 ? "situation over" : "situation"}>
      <figcaption>
        <strong>{situation.title}</strong>
        <span class="quiet">
          {kilobytes(situation.kb_per_s)} KB/s, {readable(share * 100)} % of the budget
        </span>
      </figcaption>
      <meter min={0} max={1} value={Math.min(share, 1)} aria-label={`${situation.title}: share of the budget`} />
      <table>
        <thead class="visually-hidden">
          <tr>
            <th>Topic</th>
            <th>Share</th>
            <th>Rate</th>
            <th>KB/s</th>
          </tr>
        </thead>
        <tbody>
          {loads.map((load) => (
            <tr key={load.topic}>
              <th scope="row">{load.topic}</th>
              <td class="bar-cell" aria-hidden="true">
                <span class="load" style={{ width: `${(100 * load.kb_per_s) / scale}%` }} />
              </td>
              <td class="number">{hz(load.rate_hz)}</td>
              <td class="number">{kilobytes(load.kb_per_s)} KB/s</td>
            </tr>
          ))}
        </tbody>
      </table>
    </figure>
  );
}

/** What was asked about: repairs are edits of its text. */
type Asked = Pick<Rules, "text" | "profile_text">;
/** What the optimizer says of rules, or why it refuses them. */
export type Optimized = Asked & (OptimizeAnswer | { refused: string });

/** Asks the optimizer about the rules of now; an answer that comes when they are other ones is not told. */
export async function optimized(editor: RuleEditor, tell: (answer: Optimized) => void): Promise<void> {
  const { rules } = editor;
  const { text, profile_text } = rules;
  const answer = await editor.api
    .ask("POST /api/optimize", rules)
    .catch((error: unknown) => ({ refused: refusal(error) }));
  const now = editor.rules;
  if (text === now.text && profile_text === now.profile_text) tell({ ...answer, text, profile_text });
}
