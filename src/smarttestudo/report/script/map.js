// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0

// Where the robot was at the time under the cursor, and in the stretch of time that is shown.

const REACH = 40;

function followOnMap(map) {
  const times = data.path.map(([t]) => t);
  const stretch = shape("polyline", { class: "shown-path" });
  const robot = shape("circle", { class: "robot", r: 8 });
  map.append(stretch, robot);

  time.watch(() => {
    const first = Math.max(lastIndex(times, time.from), 0);
    const last = lastIndex(times, time.to);
    const places = data.path.slice(first, last + 1);
    stretch.setAttribute("points", time.isWhole() ? "" : places.map(([, x, y]) => `${x},${y}`).join(" "));
    map.classList.toggle("zoomed", !time.isWhole());
    const place = time.now === null ? undefined : data.path[Math.max(lastIndex(times, time.now), 0)];
    robot.classList.toggle("known", place !== undefined);
    if (place) {
      robot.setAttribute("cx", place[1]);
      robot.setAttribute("cy", place[2]);
    }
  });
  map.addEventListener("pointermove", (event) => {
    const place = nearest(new DOMPoint(event.clientX, event.clientY).matrixTransform(map.getScreenCTM().inverse()));
    if (place) time.moveTo(place[0]);
  });
}

// The place on the path nearest to `point`, if one is near.
function nearest(point) {
  let best;
  let least = REACH * REACH;
  for (const place of data.path) {
    const distance = (place[1] - point.x) ** 2 + (place[2] - point.y) ** 2;
    if (distance < least) {
      least = distance;
      best = place;
    }
  }
  return best;
}
