// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
import "./style/tokens.css";
import "./style/controls.css";
import "./style/pages.css";
import "./style/bar.css";
import "./style/map.css";
import "./style/robot.css";
import "./style/try.css";
import "./style/incidents.css";
import "./style/levels.css";
import "./style/tour.css";
import "./style/picker.css";
import { render } from "preact";
import { Api } from "./api/client";
import { App } from "./app";
import { RobotLink } from "./state/robot_link";
import { RobotProvider } from "./ui/connection";

const host = document.getElementById("app");
const link = new RobotLink();
link.open();
if (host) {
  render(
    <RobotProvider value={link}>
      <App api={new Api()} />
    </RobotProvider>,
    host,
  );
}
