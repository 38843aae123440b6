// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { useEffect } from "preact/hooks";
import type { Api } from "../api/client";
import type { Project } from "../api/types";
import { href } from "../route";
import type { RuleEditor } from "../state/rule_editor";

/** Where topic parameters that are made for a rule file go. */
export const ownProfile = (rules: string) => rules.replace(/(\.adirf)?$/, ".toml");

/** Which topic parameters the rules are checked and optimized with: those chosen last, else the likeliest. */
export function ProfileChoice({ editor, api, project }: { editor: RuleEditor; api: Api; project: Project }) {
  const names = project.files.filter((file) => file.kind === "profile").map((file) => file.name);
  const storageKey = `profile of ${editor.name}`;
  const remembered = () => {
    const name = localStorage.getItem(storageKey);
    return name === "" || names.includes(name ?? "") ? name : null;
  };
  const use = (name: string) => editor.useProfile(name || null).catch((error: unknown) => editor.tell(error));
  const useLikeliest = async () => {
    try {
      const { name } = await api.profileFor(editor.rules);
      // Somebody may have chosen meanwhile.
      if (remembered() === null) await use(name ?? "");
    } catch (error) {
      editor.tell(error);
    }
  };
  useEffect(() => {
    const name = remembered();
    void (name === null ? useLikeliest() : use(name));
  }, []);
  const choose = (name: string) => {
    localStorage.setItem(storageKey, name);
    void use(name);
  };
  const chosen = editor.profile.value?.name ?? "";
  const own = ownProfile(editor.name);
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
      <a href={href({ page: "topics", name: chosen || own, rules: editor.name })}>
        {chosen || names.includes(own) ? "Edit" : "Create"}
      </a>
    </div>
  );
}
