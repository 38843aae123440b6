// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import { render } from "preact";
import { Api } from "./api/client";
import { App } from "./app";
import "./style/tokens.css";
import "./style/controls.css";
import "./style/pages.css";
import "./style/map.css";

const host = document.getElementById("app");
if (host) render(<App api={new Api()} />, host);
