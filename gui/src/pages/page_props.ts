// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Api } from "../api/client";
import type { Project } from "../api/types";
import type { KeptIncidents } from "../incidents/kept_incidents";
import type { OpenEditors } from "../state/open_editors";

/** What every page gets. */
export interface PageProps {
  api: Api;
  project: Project;
  /** The file of the page, if it is about one. */
  name: string;
  /** The rule file that topic parameters are opened for, if the address names one. */
  rules?: string | undefined;
  /** The node of the robot to show beside it, if the address names one. */
  robot?: string | undefined;
  /** The line of the rule file to show, if the address names one. */
  line?: string | undefined;
  /** Files with what was changed in them. */
  editors: OpenEditors;
  /** The incidents of tries that are being kept. */
  keptIncidents: KeptIncidents;
  /** Reads the list of files again. */
  refresh: () => Promise<void>;
}
