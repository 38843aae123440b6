// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Project } from "../api/types";
import { DOCUMENTATION_TAB, documentationHref } from "../documentation";
import { ownProfile } from "../panels/profile_choice";
import { href, NEW_PROFILE, type Route } from "../route";
import { Icon, type IconName } from "./button";
import { useRobot } from "./connection";

/** The places of the page, on its left or, where it is narrow, below. */
export function Rail({ route: { page }, project }: { route: Route; project: Project }) {
  const isAlarmed = useRobot().alarm.value !== "";
  const home = { page: "home", name: "" } as const;
  return (
    <nav class="rail" aria-label="Places">
      <img src="./icon.svg" alt="" width="32" height="32" />
      <Place to={href(home)} label="Rules" icon="rules" isHere={page === "home" || page === "rules"} />
      <Place to={href(tableOf(project))} label="Topics" icon="topics" isHere={page === "topics"} />
      <Place
        to={href({ page: "robots", name: "" })}
        label={isAlarmed ? "Robots ✕" : "Robots"}
        icon="robot"
        isHere={page === "robots"}
        isAlarmed={isAlarmed}
      />
      <Place
        to={href({ page: "incidents", name: "" })}
        label="Incidents"
        icon="incident"
        isHere={page === "incidents"}
      />
      <Place
        to={href({ page: "recordings", name: "" })}
        label="Recordings"
        icon="recording"
        isHere={page === "recordings"}
      />
      <Place to={documentationHref(page)} label="Help" icon="book" isHere={false} target={DOCUMENTATION_TAB} />
    </nav>
  );
}

interface PlaceProps {
  to: string;
  label: string;
  icon: IconName;
  isHere: boolean;
  isAlarmed?: boolean;
  target?: string;
}

function Place({ to, label, icon, isHere, isAlarmed = false, target }: PlaceProps) {
  return (
    <a href={to} class={isAlarmed ? "alarmed" : ""} aria-current={isHere ? "page" : undefined} target={target}>
      <Icon name={icon} />
      {label}
    </a>
  );
}

/** The table of topic parameters to open: the first, else a new one, for the rules where there is but one file of them. */
function tableOf({ files }: Project): Route {
  const known = files.find(({ kind }) => kind === "profile");
  if (known) return { page: "topics", name: known.name };
  const [rules, another] = files.filter(({ kind }) => kind === "rules");
  if (rules === undefined || another) return { page: "topics", name: NEW_PROFILE };
  return { page: "topics", name: ownProfile(rules.name), rules: rules.name };
}
