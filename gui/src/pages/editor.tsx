// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { effect, untracked, useSignal } from "@preact/signals";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { refusal } from "../api/client";
import type { FoundFile } from "../api/types";
import { BlocksPane, recordingOfRules } from "../panels/blocks_pane";
import { EditorBar } from "../panels/editor_bar";
import { FindingsPanel } from "../panels/findings_panel";
import { PaneButtons } from "../panels/pane_buttons";
import { ProfileChoice } from "../panels/profile_choice";
import { RateBudget } from "../panels/rate_budget";
import { RobotPanel } from "../panels/robot_panel";
import { SendDialog } from "../panels/rule_push_steps";
import { SidePane } from "../panels/side_pane";
import { ProfileRepair } from "../state/profile_repair";
import { RobotRules, RulePush } from "../state/robot_rules";
import type { RuleEditor } from "../state/rule_editor";
import { ZoneEditor } from "../state/zone_editor";
import { NeedsServer, useReturn, useRobot } from "../ui/connection";
import { ConflictDialog, FileNotices, useOpenFile } from "../ui/file_notices";
import { later } from "../ui/later";
import { Notice, Toast } from "../ui/notice";
import { FullScreen, FullScreenButton, OpenPanes, Splitter, TOOL_WORDS, type Tool, usePaneSize } from "../ui/panes";
import { showOnNarrow } from "../ui/watch";
import type { PageProps } from "./page_props";

const TryPanel = later(async () => (await import("../panels/try_panel")).TryPanel);

const BLOCKS = { least: 20, most: 80 };
const DOCK = { least: 10, most: 85 };

/** One rule file as blocks; beside them its text or map, and below them what can be said about it, when somebody wants that. */
export function EditorPage({ project, name, robot: node, line, editors, keptIncidents, refresh }: PageProps) {
  const editor = useMemo(() => editors.of(name), []);
  const panes = useMemo(() => new OpenPanes(), []);
  const robot = useRobotSide(editor);
  const tries = useMemo(() => editors.tries.of(name), []);
  const files = useRef(project.files);
  files.current = project.files;
  const recording = useMemo(() => recordingOfRules(editor, tries, () => files.current), []);
  useEffect(() => followSurroundings(editor, recording), []);
  useEffect(() => followFindings(editor, panes), []);
  const repair = useMemo(() => new ProfileRepair(editor), []);
  const zones = useMemo(() => new ZoneEditor(editor), []);
  const [side, tool] = [panes.side.value, panes.tool.value];
  const full = useMemo(() => new FullScreen(), []);
  useEffect(() => full.follow(), []);
  /** Whether the rates are to be downloaded as soon as they are known. */
  const wantsRates = useSignal(false);
  // Panes have the room that somebody left them for what they show, else as much as that needs.
  const isTried = tool === "try" && (tries.last.value ?? tries.folder.value) !== null;
  const [dock, setDock] = usePaneSize(isTried ? "a try" : "results", isTried ? 62 : 34);
  const [blocks, setBlocks] = usePaneSize("blocks", 58);
  const link = useRobot();
  useEffect(() => {
    if (node === undefined) return;
    link.choose(node);
    panes.open("robot");
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
  // What is below everything else on a narrow screen is scrolled to.
  const openTool = (next: Tool) => {
    panes.open(next);
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
      <div class="editor-top">
        <EditorBar
          {...{ editor, ...robot }}
          onSend={() => openTool("robot")}
          onDownload={() => void editor.format().then(() => (wantsRates.value = true))}
        />
        <FileNotices file={editor} />
      </div>
      <main class="panes">
        <BlocksPane
          {...{ editor, recording }}
          tried={tries.last}
          robotRules={robot.robotRules}
          budget={<RateBudget {...{ editor, project, repair, wantsRates }} />}
          hasText={() => panes.side.peek() === "text"}
          onDrawZone={(rule, rectangle) => {
            panes.open("map");
            zones.redraw(rule, rectangle);
          }}
          beside={
            side !== null && (
              <>
                <Splitter
                  label="Width of the blocks"
                  orientation="vertical"
                  percent={blocks}
                  {...BLOCKS}
                  onChange={setBlocks}
                />
                <SidePane {...{ editor, zones, side, full }} />
              </>
            )
          }
        >
          <PaneButtons
            {...{ editor, panes }}
            onTool={(next) => (next === tool ? panes.fold("tool") : openTool(next))}
          />
        </BlocksPane>
        {tool !== null && (
          <>
            <Splitter
              label="Height of the results"
              orientation="horizontal"
              percent={dock}
              {...DOCK}
              onChange={setDock}
            />
            <section class="dock" aria-label="Results" ref={results}>
              <div class="dock-bar">
                <h2>{TOOL_WORDS[tool]}</h2>
                <NeedsServer changes>
                  <ProfileChoice {...{ editor, project }} />
                </NeedsServer>
                <FullScreenButton full={full} part="results" />
              </div>
              <div class="dock-body">
                {tool === "findings" && <FindingsPanel {...{ editor, repair }} />}
                {tool === "robot" && (
                  <NeedsServer>
                    <RobotPanel {...{ editor, ...robot }} />
                  </NeedsServer>
                )}
                {tool === "try" && <TryPanel {...{ editor, project, tries, keptIncidents, refresh }} />}
              </div>
            </section>
          </>
        )}
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

/** Unfolds the text for a finding at a place that no block shows. */
function followFindings(editor: RuleEditor, panes: OpenPanes): () => void {
  const before = editor.spot.peek();
  return effect(() => {
    const spot = editor.spot.value;
    if (spot?.from !== "findings" || spot === before || panes.side.peek() === "text") return;
    if (!editor.isBroken.peek() && untracked(() => editor.statementAt(spot.offset)) !== undefined) return;
    panes.open("text");
    // The text can only scroll to a place once it is to be seen.
    requestAnimationFrame(() => (editor.spot.value = { ...spot }));
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
