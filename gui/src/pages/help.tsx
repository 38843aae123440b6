// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { DocumentationReader } from "../documentation/reader";
import { Header } from "../ui/header";
import type { PageProps } from "./page_props";

/** The documentation as a page of its own; `name` is the place to show. */
export function HelpPage({ name }: PageProps) {
  return (
    <>
      <Header title="Documentation" />
      <DocumentationReader anchor={name} isSearchFirst={false} />
    </>
  );
}
