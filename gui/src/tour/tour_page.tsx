// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

import { useEffect, useMemo } from "preact/hooks";
import { Api, ApiError } from "../api/client";
import type { FileAnswer, FoundFile, Project } from "../api/types";
import { EditorPage } from "../pages/editor";
import type { PageProps } from "../pages/page_props";
import { toRoute } from "../route";
import { type DraftStorage, Drafts } from "../state/drafts";
import { OpenEditors } from "../state/open_editors";
import { focusPageSoon } from "../ui/dialog";
import rules from "./example.adirf?raw";
import parameters from "./example.toml?raw";
import { TourCard } from "./tour_card";

/** The editor on an example that is in no file, and the tour of it; `rules` is the file that it was called from. */
export function TourPage({ project, refresh, rules, keepings }: PageProps) {
  const own = useMemo(
    () => ({ api: new ExampleApi(), editors: exampleEditors(), project: exampleProject(project) }),
    [],
  );
  useEffect(() => focusPageSoon, []);
  const end = () => toRoute(rules === undefined ? { page: "home", name: "" } : { page: "rules", name: rules });
  return (
    <div class="touring">
      <EditorPage {...own} {...{ refresh, keepings }} name={EXAMPLE_RULES} />
      <TourCard onEnd={end} />
    </div>
  );
}

export const EXAMPLE_RULES = "example.adirf";
const EXAMPLE_PARAMETERS = "example.toml";
const TEXTS: Readonly<Record<string, string>> = { [EXAMPLE_RULES]: rules, [EXAMPLE_PARAMETERS]: parameters };

/** The server, but for files: the example is in none, and none of the project's is read or written. */
export class ExampleApi extends Api {
  override async read(name: string): Promise<FileAnswer> {
    const text = TEXTS[name];
    if (text === undefined) throw refusal(404, `${name} is not part of the example`);
    return { name, text, hash: "" };
  }

  override async fileState() {
    return { hash: "" };
  }

  override async save(): Promise<never> {
    throw refusal(403, "The example is not saved");
  }

  override async push(): Promise<never> {
    throw refusal(403, "The example is not sent to a robot");
  }

  override async profileFor() {
    return { name: EXAMPLE_PARAMETERS, gone: null };
  }

  override async chooseProfile(_rules: string, name: string | null) {
    return { name, gone: null };
  }

  override async versions() {
    return { folder: "", versions: [], most: 0 };
  }
}

/** The project as the example sees it: two files of its own, and the recordings that rules can be tried on. */
function exampleProject(project: Project): Project {
  const own = (name: string, kind: FoundFile["kind"]) => ({ name, kind, size_bytes: 0, changed_at_s: 0 });
  return {
    ...project,
    saves_by_itself: false,
    files: [
      own(EXAMPLE_RULES, "rules"),
      own(EXAMPLE_PARAMETERS, "profile"),
      ...project.files.filter(({ kind }) => kind === "bag"),
    ],
  };
}

/** Editors of the example, of which no draft is kept. */
function exampleEditors(): OpenEditors {
  return new OpenEditors(new Drafts(FORGETTING, "example", "", async () => new Set()));
}

const FORGETTING: DraftStorage = {
  length: 0,
  key: () => null,
  getItem: () => null,
  setItem: () => undefined,
  removeItem: () => undefined,
};

function refusal(status: number, message: string): ApiError {
  const remedy = "New Rule File on the first screen makes rules of your own";
  return new ApiError(status, { message, remedy, place: "", findings: [] });
}
