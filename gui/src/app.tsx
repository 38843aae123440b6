// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { type Signal, useSignalEffect } from "@preact/signals";
import type { ComponentType } from "preact";
import { useEffect, useMemo, useState } from "preact/hooks";
import { type Api, refusalOf } from "./api/client";
import type { Project } from "./api/types";
import { openDocumentation } from "./documentation";
import { KeptIncidents, KeptIncidentsBar } from "./incidents/kept_incidents";
import { HomePage } from "./pages/home";
import type { PageProps } from "./pages/page_props";
import { href, NEW_PROFILE, type Route, readRoute, toRoute } from "./route";
import { browserStorage, LocalDrafts } from "./state/drafts";
import { OpenEditors } from "./state/open_editors";
import type { LostChanges } from "./state/rule_editor";
import { TourOffer } from "./tour/tour_offer";
import { Button } from "./ui/button";
import { ServerGone, useReturn, useRobot, WatchNotice } from "./ui/connection";
import { useDroppedFile } from "./ui/files";
import { type Later, later } from "./ui/later";
import { Notice } from "./ui/notice";
import { Rail } from "./ui/rail";
import { useWindowEvent } from "./ui/watch";

// The heavy parts (Blockly, CodeMirror, plots) load with the page that needs them.
const PAGES: Record<Exclude<Route["page"], "home">, Later<PageProps>> = {
  rules: later(async () => {
    const page = import("./pages/editor");
    void import("./blocks/rule_workspace");
    return (await page).EditorPage;
  }),
  topics: later(async () => (await import("./pages/topics")).TopicsPage),
  tour: later(async () => (await import("./tour/tour_page")).TourPage),
  robots: later(async () => (await import("./pages/robots")).RobotsPage),
  incidents: later(async () => (await import("./pages/incidents")).IncidentsPage),
  recordings: later(async () => (await import("./pages/recordings")).RecordingsPage),
};

/** The pages that do something with a file that is dropped on them. */
const TAKE_FILES: ReadonlySet<Route["page"]> = new Set(["home", "tour"]);

export function App({ api }: { api: Api }) {
  const [project, setProject] = useState<Project | null>(null);
  const [problem, setProblem] = useState("");
  const root = project?.root_hash;
  const link = useRobot();
  const editors = useMemo(() => {
    if (root === undefined) return null;
    const page = crypto.getRandomValues(new Uint32Array(4)).join("-");
    const canSend = () => !link.isServerGone.peek() && !link.onlyWatches.peek();
    return new OpenEditors(api, new LocalDrafts(browserStorage(), root, page, canSend));
  }, [root]);
  const keptIncidents = useMemo(() => new KeptIncidents(api), []);
  useWindowEvent("beforeunload", (event) => {
    if (editors?.wouldLose) event.preventDefault();
  });
  useWindowEvent("keydown", (event) => {
    if (event.key !== "F1") return;
    event.preventDefault();
    openDocumentation();
  });
  const route = useRoute();
  const [missing, setMissing] = useState("");
  useEffect(() => {
    if (route.page !== "home") setMissing("");
  }, [route]);
  const refresh = async () => {
    setProblem(await refusalOf(async () => setProject(await api.project())));
  };
  useEffect(() => {
    // The page comes while the server lists the project.
    if (route.page !== "home") PAGES[route.page].preload();
    // Files may have been saved, added or removed, also by others, since they were listed.
    const look = () => void refresh();
    look();
    addEventListener("focus", look);
    return () => removeEventListener("focus", look);
  }, [route.page]);
  useEffect(() => {
    if (project?.opened && location.hash === "") toRoute({ page: "rules", name: project.opened });
  }, [project?.opened]);
  useEffect(() => void keptIncidents.follow(), []);
  const { alarm, returns } = link;
  useSignalEffect(() => {
    document.title = alarm.value ? `✕ ${alarm.value} · ADIRF Ruler` : "ADIRF Ruler";
  });
  /** A file that was dropped where nothing takes one. */
  const [dropped, setDropped] = useState("");
  useDroppedFile((file) => setDropped(TAKE_FILES.has(route.page) ? "" : file.name));
  useReturn(() => Promise.all([refresh(), keptIncidents.follow()]));
  if (problem && project === null)
    return <Notice kind="error" text={problem} action={{ label: "Try again", act: refresh }} />;
  if (project === null || editors === null) return <p class="quiet center">Opening the project …</p>;
  const props = { ...route, api, project, refresh, editors, keptIncidents };
  // What these pages show is all the server's: they begin anew with it.
  const anew = ["home", "rules", "topics"].includes(route.page) ? 0 : returns.value;
  return (
    <>
      <Button
        label="Skip to the content"
        class="skip"
        onClick={() => document.querySelector<HTMLElement>("h1")?.focus()}
      />
      <Rail {...{ route, project }} />
      <ServerGone />
      <WatchNotice />
      <KeptIncidentsBar keptIncidents={keptIncidents} />
      <LostNotice lost={editors.lost} />
      {dropped && (
        <Notice
          kind="warning"
          text={`${dropped} was not taken: drop it on the first screen`}
          action={{ label: "Close", act: () => setDropped("") }}
        />
      )}
      {route.page === "home" ? (
        <HomePage {...props} missing={missing} />
      ) : (
        <KnownFile
          key={`${root} ${anew} ${route.page} ${route.name}`}
          Page={PAGES[route.page]}
          {...{ route, props }}
          onMissing={setMissing}
        />
      )}
      <TourOffer route={route} />
    </>
  );
}

/** Says what somebody left in the blocks of a file and its text did not take. */
function LostNotice({ lost }: { lost: Signal<LostChanges | null> }) {
  if (lost.value === null) return null;
  const { name, changes, why } = lost.value;
  const text = `${name}: what the blocks said did not come into the text: ${changes.join("; ")}. ${why}`;
  return <Notice kind="error" text={text} action={{ label: "Close", act: () => (lost.value = null) }} />;
}

function useRoute(): Route {
  const [route, setRoute] = useState(readRoute);
  useWindowEvent("hashchange", () => setRoute(readRoute()));
  return route;
}

interface Props {
  Page: ComponentType<PageProps>;
  route: Route;
  props: PageProps;
  onMissing: (name: string) => void;
}

/** The page of a file that is there, or of none; the address of one that is not there leads home. */
function KnownFile({ Page, route, props, onMissing }: Props) {
  const [isThere, setIsThere] = useState(mayBeNew(route, props));
  useEffect(() => {
    if (isThere) return;
    props.api.fileState(route.name).then(
      async ({ hash }) => {
        if (hash !== null || (await props.api.draft(route.name)).draft !== null) return setIsThere(true);
        onMissing(route.name);
        location.replace(href({ page: "home", name: "" }));
      },
      // The page says itself why a file cannot be read.
      () => setIsThere(true),
    );
  }, []);
  return isThere ? <Page {...props} /> : <p class="quiet center">Loading …</p>;
}

/** Whether the page of the address shows no file, one that is known, or a table that begins with it. */
function mayBeNew({ page, name, rules }: Route, { project, editors }: PageProps): boolean {
  if (page !== "rules" && page !== "topics") return true;
  const isKnown = (kind: "rules" | "profile") =>
    editors.unsaved().includes(name) || project.files.some((file) => file.kind === kind && file.name === name);
  if (page === "rules") return isKnown("rules");
  return isKnown("profile") || rules !== undefined || name === NEW_PROFILE;
}
