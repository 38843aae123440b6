// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useState } from "preact/hooks";
import type { FoundFile } from "../api/types";
import { RecordingStart } from "../panels/project_start";
import { readRoute, toRoute } from "../route";
import { Button } from "../ui/button";
import { NeedsServer } from "../ui/connection";
import { baseName, byFolder } from "../ui/files";
import { Header } from "../ui/header";
import { Breakable } from "../ui/notice";
import { ago, moment, sizeWords } from "../ui/numbers";
import type { PageProps } from "./page_props";

const ALL = { page: "recordings", name: "" } as const;
/** A folder with more is closed at first, as that of a robot's incidents. */
const FEW = 10;

/** The recordings of the project; with a name, what to make of that one. */
export function RecordingsPage({ api, project, refresh, name }: PageProps) {
  const bags = project.files.filter(({ kind }) => kind === "bag").sort((a, b) => b.changed_at_s - a.changed_at_s);
  const [chosen, setChosen] = useState(name);
  const close = () => {
    setChosen("");
    // Rules that were made of it are open by then.
    if (name !== "" && readRoute().page === "recordings") toRoute(ALL);
  };
  return (
    <>
      <Header title="Recordings" />
      <main class="home">
        <section aria-label="Recordings" class="file-list">
          {bags.length === 0 && (
            <p class="quiet">
              No recording in {project.root_name}. Drop a .mcap or .db3 file on <em>Rules</em>, or copy a folder of ros2
              bag into the project.
            </p>
          )}
          {[...byFolder(bags)].map(([folder, some]) =>
            folder === "" ? (
              <BagRows bags={some} choose={setChosen} />
            ) : (
              <details key={folder} open={some.length <= FEW}>
                <summary>
                  {folder} <span class="quiet">{some.length}</span>
                </summary>
                <BagRows bags={some} choose={setChosen} />
              </details>
            ),
          )}
        </section>
        {chosen !== "" && <RecordingStart {...{ api, project, refresh }} bag={chosen} onClose={close} />}
      </main>
    </>
  );
}

function BagRows({ bags, choose }: { bags: readonly FoundFile[]; choose: (name: string) => void }) {
  return (
    <ul class="files">
      {bags.map((bag) => (
        <li key={bag.name}>
          <span class="file-name">
            <Breakable name={baseName(bag.name)} />
            {bag.name.endsWith(".bag") && " (ROS 1)"}
          </span>
          <span class="file-notes quiet">
            <span>{sizeWords(bag.size_bytes / 1000)}</span>
            <time title={moment(1000 * bag.changed_at_s)}>{ago(1000 * bag.changed_at_s, Date.now())}</time>
          </span>
          <NeedsServer changes>
            <Button
              label="New rules from it"
              aria-label={`New rules from ${bag.name}`}
              onClick={() => choose(bag.name)}
            />
          </NeedsServer>
        </li>
      ))}
    </ul>
  );
}
