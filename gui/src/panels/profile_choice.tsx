// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect } from "preact/hooks";
import type { Project } from "../api/types";
import { href } from "../route";
import type { RuleEditor } from "../state/rule_editor";

const folder = (name: string) => name.slice(0, name.lastIndexOf("/") + 1);

/** Which topic parameters the rules are checked and optimized with. */
export function ProfileChoice({ editor, project }: { editor: RuleEditor; project: Project }) {
  const names = project.files.filter((file) => file.kind === "profile").map((file) => file.name);
  const storageKey = `profile of ${editor.name}`;
  useEffect(() => {
    const remembered = localStorage.getItem(storageKey);
    const near = names.filter((name) => folder(name) === folder(editor.name));
    void editor.useProfile(remembered !== null && names.includes(remembered) ? remembered : (near[0] ?? null));
  }, []);
  const choose = (name: string) => {
    localStorage.setItem(storageKey, name);
    void editor.useProfile(name || null);
  };
  const chosen = editor.profile.value?.name ?? "";
  return (
    <div class="row profile-choice">
      <label>
        Topic parameters
        <select value={chosen} onChange={(event) => choose(event.currentTarget.value)}>
          <option value="">none</option>
          {names.map((name) => (
            <option key={name} value={name}>
              {name}
            </option>
          ))}
        </select>
      </label>
      <a href={href({ page: "topics", name: chosen || "profile.toml" })}>{chosen ? "Edit" : "Create"}</a>
    </div>
  );
}
