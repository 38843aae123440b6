// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, type Signal, useSignal } from "@preact/signals";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { refusal } from "../api/client";
import type { FoundFile } from "../api/types";
import { BlocksPane, recordingOfRules } from "../panels/blocks_pane";
import { EditorBar } from "../panels/editor_bar";
import { FindingsPanel } from "../panels/findings_panel";
import { BudgetBar, followRates, type Optimized, OptimizePanel } from "../panels/optimize_panel";
import { ProfileChoice } from "../panels/profile_choice";
import { RobotPanel } from "../panels/robot_panel";
import { SendDialog } from "../panels/rule_push_steps";
import { type Side, SidePane } from "../panels/side_pane";
import { ProfileRepair } from "../state/profile_repair";
import { RobotRules, RulePush } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { ZoneEditor } from "../state/zone_editor";
import { type Tab, Tabs } from "../ui/choice";
import { NeedsServer, useReturn, useRobot } from "../ui/connection";
import { ConflictDialog, FileNotices, useOpenFile } from "../ui/file_notices";
import { later } from "../ui/later";
import { Notice, Toast } from "../ui/notice";
import { FullScreen, FullScreenButton, Splitter, usePaneSize } from "../ui/panes";
import { showOnNarrow } from "../ui/watch";
import type { PageProps } from "./page_props";

const TryPanel = later(async () => (await import("../panels/try_panel")).TryPanel);

export type Tool = "findings" | "optimize" | "try" | "robot";

const BLOCKS = { least: 20, most: 80 };
const DOCK = { least: 10, most: 85 };

/** Blocks and text of one rule file side by side, and below them what can be said about it. */
export function EditorPage({ project, name, robot: node, line, editors, keptIncidents, refresh }: PageProps) {
  const editor = useMemo(() => editors.of(name), []);
  const robot = useRobotSide(editor);
  const tries = useMemo(() => editors.tries.of(name), []);
  const files = useRef(project.files);
  files.current = project.files;
  const recording = useMemo(() => recordingOfRules(editor, tries, () => files.current), []);
  useEffect(() => followSurroundings(editor, recording), []);
  const repair = useMemo(() => new ProfileRepair(editor), []);
  const tool = useSignal<Tool>("findings");
  const side = useSignal<Side>("text");
  const zones = useMemo(() => new ZoneEditor(editor), []);
  const full = useMemo(() => new FullScreen(), []);
  useEffect(() => full.follow(), []);
  /** Whether the rates are to be downloaded as soon as they are computed. */
  const wantsRates = useSignal(false);
  const rates = useSignal<Optimized | null>(null);
  useEffect(() => followRates(editor, rates, () => tool.value === "optimize"), []);
  // Panes have the room that somebody left them for what they show, else as much as that needs.
  const isTried = tool.value === "try" && (tries.last.value ?? tries.folder.value) !== null;
  const isMap = side.value === "map";
  const dockOf = isTried ? "a try" : isMap ? "results below the map" : "results";
  const [dock, setDock] = usePaneSize(dockOf, isTried ? 62 : isMap ? 18 : 34);
  const [blocks, setBlocks] = usePaneSize("blocks", 58);
  const link = useRobot();
  useEffect(() => {
    if (node === undefined) return;
    link.choose(node);
    tool.value = "robot";
  }, [node]);
  const [state, setState] = useState<"opening" | "open" | { problem: string }>("opening");
  useEffect(() => {
    void open(editor, setState);
  }, []);
  useOpenFile(editor, () => editor.save());
  useReturn(() => {
    if (state === "open") return editor.revive();
    return state !== "opening" && open(editor, setState);
  });
  const results = useRef<HTMLElement>(null);
  const openTool = (next: Tool) => {
    tool.value = next;
    editor.showAllFindings();
    if (full.part.peek() === "map") full.leave();
    showOnNarrow(() => results.current);
  };
  useEffect(() => {
    if (state === "open" && line !== undefined) editor.showLine(Number(line));
  }, [state]);
  if (state === "opening") return <p class="quiet center">Opening {name} …</p>;
  if (state !== "open") return <Notice kind="error" text={state.problem} />;
  return (
    <div class="editor" data-full={full.part.value} style={{ "--dock": `${dock}%`, "--blocks": `${blocks}%` }}>
      <div>
        <EditorBar
          {...{ editor, project, ...robot }}
          onTool={openTool}
          onDownload={() => {
            openTool("optimize");
            wantsRates.value = true;
          }}
        />
        <FileNotices file={editor} />
      </div>
      <main class="panes">
        <div class="split">
          <BlocksPane
            {...{ editor, recording }}
            tried={tries.last}
            robotRules={robot.robotRules}
            onDrawZone={(rule, rectangle) => {
              side.value = "map";
              zones.redraw(rule, rectangle);
            }}
          >
            <BudgetBar {...{ editor, rates }} onOpen={() => openTool("optimize")} />
          </BlocksPane>
          <Splitter
            label="Width of the blocks"
            orientation="vertical"
            percent={blocks}
            {...BLOCKS}
            onChange={setBlocks}
          />
          <SidePane {...{ editor, zones, side, full }} />
        </div>
        <Splitter label="Height of the results" orientation="horizontal" percent={dock} {...DOCK} onChange={setDock} />
        <section class="dock" aria-label="Results" ref={results}>
          <h2 class="visually-hidden">Results</h2>
          <div class="dock-bar">
            <ResultTabs {...{ editor, tool }} />
            <NeedsServer changes>
              <ProfileChoice {...{ editor, project }} />
            </NeedsServer>
            <FullScreenButton full={full} part="results" />
          </div>
          <div class="dock-body" role="tabpanel" aria-label={tool.value}>
            {tool.value === "findings" && <FindingsPanel {...{ editor, repair }} />}
            {tool.value === "optimize" && (
              <NeedsServer>
                <OptimizePanel {...{ editor, project, repair, rates, wantsRates }} />
              </NeedsServer>
            )}
            {tool.value === "robot" && (
              <NeedsServer>
                <RobotPanel {...{ editor, ...robot }} />
              </NeedsServer>
            )}
            {tool.value === "try" && <TryPanel {...{ editor, project, tries, keptIncidents, refresh }} />}
          </div>
        </section>
      </main>
      <Toast message={editor.message} />
      <ConflictDialog file={editor} />
      <SendDialog rulePush={robot.rulePush} />
    </div>
  );
}

/** What links the open rules with a running robot, for as long as the page is open. */
function useRobotSide(editor: RuleEditor): { robotRules: RobotRules; rulePush: RulePush } {
  const link = useRobot();
  const side = useMemo(() => ({ robotRules: new RobotRules(editor, link), rulePush: new RulePush(editor, link) }), []);
  useEffect(() => side.robotRules.follow(), []);
  useEffect(() => side.rulePush.follow(), []);
  return side;
}

/** The tabs of the results; how many findings there are changes more often than the page. */
function ResultTabs({ editor, tool }: { editor: RuleEditor; tool: Signal<Tool> }) {
  const count = editor.isChecked.value ? editor.findings.value.length : "…";
  const choices: Tab<Tool>[] = [
    { value: "findings", label: `Findings (${count})` },
    { value: "optimize", label: "Optimize" },
    { value: "try", label: "Try on a recording" },
    { value: "robot", label: "Robot" },
  ];
  return <Tabs label="Results" choices={choices} chosen={tool} />;
}

/** Looks at what is beside the text whenever it was read without an error. */
function followSurroundings(editor: RuleEditor, recording: () => FoundFile | undefined): () => void {
  editor.surroundings.recordedTopics = async () => {
    const bag = recording()?.name;
    return bag === undefined ? [] : (await editor.api.ask("POST /api/recording", { bag })).topics;
  };
  return effect(() => {
    if (editor.isChecked.value && editor.document.value && editor.errors.value.length === 0) editor.surroundings.soon();
  });
}

type Opened = "open" | { problem: string };

async function open(editor: RuleEditor, done: (state: Opened) => void): Promise<void> {
  try {
    if (editor.isOpen.peek()) void editor.recallProfile();
    else await editor.open();
    done("open");
  } catch (error) {
    done({ problem: refusal(error) });
  }
}
