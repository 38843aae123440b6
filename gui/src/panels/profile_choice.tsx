// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import type { Project } from "../api/types";
import { href } from "../route";
import type { ProfileRepair } from "../state/profile_repair";
import type { RuleEditor } from "../state/rule_editor";
import { Choice } from "../ui/choice";
import { Notice } from "../ui/notice";

/** Where topic parameters that are made for a rule file go. */
export const ownProfile = (rules: string) => rules.replace(/(\.adirf)?$/, ".toml");

/** Which topic parameters the rules are checked and optimized with: those chosen last by anybody, else the likeliest. */
export function ProfileChoice({ editor, project }: { editor: RuleEditor; project: Project }) {
  const chosen = editor.profile.value?.name ?? "";
  const listed = project.files.filter((file) => file.kind === "profile").map((file) => file.name);
  // One that was saved just now may not be listed yet.
  const names = chosen === "" || listed.includes(chosen) ? listed : [...listed, chosen];
  const gone = editor.profileChoice.gone.value;
  const choose = async (name: string) => {
    await Promise.all([editor.api.chooseProfile(editor.name, name || null), editor.useProfile(name || null)]);
  };
  const own = ownProfile(editor.name);
  return (
    <div class="row profile-choice">
      {gone !== null && (
        <span class="problem" role="status">
          {gone} is gone
        </span>
      )}
      <Choice
        label="Profile (topic parameters)"
        value={chosen}
        choices={[["", "none"], ...names]}
        choose={(name) => void editor.attempt(() => choose(name))}
      />
      <a href={href({ page: "topics", name: chosen || own, rules: editor.name })}>
        {chosen || names.includes(own) ? "Edit" : "Create"}
      </a>
    </div>
  );
}

/** What was changed in another file than the one that is open, with the way back. */
export function ProfileChangeNotice({ repair }: { repair: ProfileRepair }) {
  const change = repair.done.value;
  if (change === null) return null;
  return <Notice kind="info" text={change.words} action={{ label: "Take it back", act: change.takeBack }} />;
}
