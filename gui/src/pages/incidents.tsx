// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from "preact/hooks";
import type { Api } from "../api/client";
import type { IncidentAnswer, IncidentCourse, IncidentsAnswer, ListedIncident } from "../api/types";
import { CourseView, IncidentFacts, RecordedTopics, useRuleGround } from "../incidents/incident";
import { IncidentTable } from "../incidents/incident_table";
import { sumOf } from "../incidents/missing_words";
import { RobotIncidentList, RobotIncidents } from "../incidents/robot_incidents";
import { href, toRoute } from "../route";
import { BagWork } from "../state/bag_work";
import { Button } from "../ui/button";
import { NeedsServer } from "../ui/connection";
import { FormDialog } from "../ui/dialog";
import { baseName } from "../ui/files";
import { Header } from "../ui/header";
import { useAnswer } from "../ui/later";
import { Notice, WorkProgress } from "../ui/notice";
import { counted, moment, NS_PER_MS, sizeWords } from "../ui/numbers";
import type { PageProps } from "./page_props";

const ALL = { page: "incidents", name: "" } as const;

/** What rules recorded: all incidents, or, with a name, that one. */
export function IncidentsPage({ api, project, name }: PageProps) {
  return name === "" ? <AllIncidents {...{ api }} root={project.root_name} /> : <OneIncident {...{ api, name }} />;
}

function AllIncidents({ api, root }: { api: Api; root: string }) {
  const { answer: found, problem, again: read, take } = useAnswer(() => api.ask("GET /api/incidents", null));
  const robots = useMemo(() => new RobotIncidents(api, () => void read()), []);
  useEffect(() => robots.open(), []);
  const [removed, setRemoved] = useState<ListedIncident | null>(null);
  return (
    <>
      <Header title="Incidents">
        <Button
          label="Refresh"
          onClick={() => {
            void read();
            void robots.ask();
          }}
        />
      </Header>
      <main class="robots incidents">
        {problem && <Notice kind="error" text={problem} action={{ label: "Try again", act: read }} />}
        {found === null && !problem && <p class="quiet">Looking for incidents …</p>}
        {found !== null && <p role="status">{countWords(found)}</p>}
        {found?.incidents.length === 0 && <HowToGetSome root={root} />}
        {found !== null && found.incidents.length > 0 && (
          <IncidentTable incidents={found.incidents} remove={setRemoved} />
        )}
        <RobotIncidentList robots={robots} />
      </main>
      {removed && (
        <DeleteDialog
          api={api}
          name={removed.name}
          size_bytes={removed.size_bytes}
          lost={removed.incident && { ...removed.incident, title: removed.incident.label }}
          onDeleted={(left) => {
            take(left);
            void robots.ask();
            setRemoved(null);
          }}
          onClose={() => setRemoved(null)}
        />
      )}
    </>
  );
}

function countWords({ incidents, has_more }: IncidentsAnswer): string {
  const unread = incidents.filter(({ incident }) => incident?.is_read === false).length;
  const bad = incidents.filter(({ incident }) => incident === null).length;
  return [
    counted(incidents.length, "incident"),
    unread > 0 ? `${unread} not read yet` : "",
    bad > 0 ? `${bad} that cannot be read` : "",
    has_more ? "older ones are not shown" : "",
  ]
    .filter(Boolean)
    .join(", ");
}

function HowToGetSome({ root }: { root: string }) {
  return (
    <div class="how-to">
      <p>
        An incident is what a rule recorded: everything around the moment at which it began to hold. There is none in{" "}
        {root} yet. To get one:
      </p>
      <ul>
        <li>
          put <em>record</em> from the list of blocks into a rule, and <em>Try on a recording</em>: the try shows what
          would have been recorded, and keeps it here if you like;
        </li>
        <li>
          on a robot, start <code>testudo run --link --incidents DIR</code>, and connect this page to it with{" "}
          <code>testudo ruler --connect</code>; or copy that folder into the project.
        </li>
      </ul>
    </div>
  );
}

function OneIncident({ api, name }: Pick<PageProps, "api" | "name">) {
  const { answer: incident, problem, again: read } = useAnswer(() => api.ask("POST /api/incident", { name }));
  const course = useMemo(() => new BagWork<IncidentCourse>(), []);
  const [isAsked, setAsked] = useState(false);
  useEffect(() => {
    void course.start((run, signal) => api.ask("POST /api/incident/course", { name, run }, { signal }));
    return () => course.cancel();
  }, []);
  const state = course.state.value;
  return (
    <>
      <Header title={incident?.record.name ?? baseName(name)} />
      <main class="incident">
        <div class="row">
          <a href={href(ALL)}>All incidents</a>
          {incident && (
            <>
              <a class="button" href={`api/incident/zip?name=${encodeURIComponent(name)}`} download>
                Download
              </a>
              <NeedsServer changes>
                <Button label="Delete" onClick={() => setAsked(true)} />
              </NeedsServer>
            </>
          )}
        </div>
        {problem && <Notice kind="error" text={problem} action={{ label: "Try again", act: read }} />}
        {incident && <Seen {...{ api, incident }} course={state.kind === "done" ? state.answer : null} />}
        {!problem && <WorkProgress work={course} doing="Reading its messages" />}
        {incident && <RecordedTopics record={incident.record} />}
      </main>
      {incident && isAsked && (
        <DeleteDialog
          {...{ api, name, size_bytes: incident.size_bytes }}
          lost={{
            title: incident.record.name,
            triggered_ns: incident.record.triggered_ns,
            messages: sumOf(incident.record.topics, "messages"),
          }}
          onDeleted={() => toRoute(ALL)}
          onClose={() => setAsked(false)}
        />
      )}
    </>
  );
}

interface SeenProps {
  api: Api;
  incident: IncidentAnswer;
  /** Null until its messages are read. */
  course: IncidentCourse | null;
}

function Seen({ api, incident, course }: SeenProps) {
  const ground = useRuleGround(api, incident);
  return (
    <>
      <IncidentFacts {...{ incident, ground }} />
      {course && <CourseView {...{ api, incident, course, ground }} />}
    </>
  );
}

interface DeleteDialogProps {
  api: Api;
  name: string;
  size_bytes: number;
  /** What is deleted: its title, when it was and its messages; null where it cannot be read. */
  lost: { title: string; triggered_ns: number; messages: number } | null;
  onDeleted: (left: IncidentsAnswer) => void;
  onClose: () => void;
}

/** Asks before an incident is deleted, and says what is lost. */
function DeleteDialog({ api, name, size_bytes, lost, onDeleted, onClose }: DeleteDialogProps) {
  const size = sizeWords(size_bytes / 1000);
  const remove = async () => onDeleted(await api.ask("POST /api/incident/delete", { name }));
  return (
    <FormDialog title="Delete this incident?" submit="Delete" onSubmit={remove} onClose={onClose}>
      {lost === null ? (
        <p>Its record cannot be read, but its messages may still be there: {size}.</p>
      ) : (
        <p>
          <strong>{lost.title}</strong> of {moment(lost.triggered_ns / NS_PER_MS)}: {counted(lost.messages, "message")},{" "}
          {size}.
        </p>
      )}
      <p class="path">{name}</p>
      <p>The folder is deleted from the disk and cannot be had back.</p>
    </FormDialog>
  );
}
