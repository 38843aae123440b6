# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What zones are drawn on: maps, images and paths of the project, and nothing from outside it."""

from __future__ import annotations

import io
import runpy
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlencode

import numpy as np
import pytest
from PIL import Image

from bags.bag_factory import small_mission, write_bag
from ruler.ruler_server import EXAMPLES, Answer, Page, served
from smarttestudo.simulation.warehouse import warehouse

HEADER = "image: {image}\nresolution: 0.5\norigin: [-1.0, -2.0, 0.25]\nnegate: 0\n"


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    outside = tmp_path_factory.mktemp("outside")
    Image.new("L", (2, 2)).save(outside / "secret.png")
    folder = tmp_path_factory.mktemp("project")
    write_bag(folder / "monday", small_mission())
    cells = np.array([[0, 254, 205], [254, 254, 254]], np.uint8)
    Image.fromarray(cells).save(folder / "hall.pgm")
    (folder / "hall.yaml").write_text(HEADER.format(image="hall.pgm"))
    (folder / "outside.yaml").write_text(HEADER.format(image=f"../{outside.name}/secret.png"))
    (folder / "absolute.yaml").write_text(HEADER.format(image=outside / "secret.png"))
    (folder / "link.png").symlink_to(outside / "secret.png")
    (folder / "broken.yaml").write_text("image: hall.pgm\nresolution: 0.5\norigin: [1, 2\nnegate: 0\n")
    (folder / "short.yaml").write_text("image: hall.pgm\norigin: [0, 0, 0]\n# resolution: 1\n")
    (folder / "huge.png").write_bytes(png_that_claims(60_000, 60_000))
    (folder / "huge.yaml").write_text(HEADER.format(image="huge.png"))
    (folder / "text.png").write_text("<script>alert(1)</script>")
    (folder / "<script>alert(1)<").mkdir()
    Image.new("RGB", (4, 3), "red").save(folder / "<script>alert(1)<" / "script>.JPG", "JPEG")
    return folder


@pytest.fixture(scope="module")
def page(project: Path) -> Iterator[Page]:
    with served(project) as page:
        yield page


def png_that_claims(width: int, height: int) -> bytes:
    """A PNG of a few bytes whose header promises far more."""
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(b"\0" * 64)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )


def picture(page: Page, kind: str, name: str) -> Answer:
    return page.get(f"/api/background/picture?{urlencode({'kind': kind, 'name': name})}")


def test_maps_images_and_recordings_of_the_project_are_offered(page: Page) -> None:
    choices = {(one["kind"], one["name"]) for one in page.get("/api/backgrounds").json["choices"]}
    assert {("map", "hall.yaml"), ("bag", "monday"), ("image", "<script>alert(1)</script>.JPG")} <= choices
    assert ("image", "link.png") not in choices
    assert {one["kind"] for one in page.get("/api/project").json["files"]} == {"map", "bag"}


def test_a_map_says_where_it_lies_and_is_a_picture_whose_walls_are_opaque(page: Page, project: Path) -> None:
    found = page.post("/api/background", {"kind": "map", "name": "hall.yaml"}).json
    assert (found["width_px"], found["height_px"], found["metres_per_pixel"]) == (3, 2, 0.5)
    assert (found["x"], found["y"], found["yaw_rad"]) == (-1, -2, 0.25)
    answer = picture(page, "map", "hall.yaml")
    assert (answer.status, answer.headers["content-type"]) == (200, "image/png")
    opacity = np.asarray(Image.open(io.BytesIO(answer.body)))[..., 1]
    assert (opacity[0, 0], opacity[0, 1], opacity[1].any()) == (255, 0, False)
    assert 0 < opacity[0, 2] < 255
    (project / "hall.yaml").write_text(HEADER.format(image="hall.pgm").replace("-1.0", "-1.5"))
    changed = page.post("/api/background", {"kind": "map", "name": "hall.yaml"}).json
    assert changed["hash"] != found["hash"]
    (project / "hall.yaml").write_text(HEADER.format(image="hall.pgm"))


def test_an_image_is_sent_as_png_whatever_it_was(page: Page) -> None:
    name = "<script>alert(1)</script>.JPG"
    found = page.post("/api/background", {"kind": "image", "name": name}).json
    assert (found["width_px"], found["height_px"], found["metres_per_pixel"]) == (4, 3, None)
    answer = picture(page, "image", name)
    assert answer.headers["content-type"] == "image/png"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.body.startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("kind", "name", "status"),
    [
        ("map", "../hall.yaml", 403),
        ("image", "../outside/secret.png", 403),
        ("image", "/etc/passwd", 403),
        ("image", "hall.yaml", 403),
        ("map", "hall.pgm", 403),
        ("image", "link.png", 403),
        ("map", "outside.yaml", 403),
        ("map", "absolute.yaml", 403),
        ("map", "nowhere.yaml", 404),
        ("bag", "monday", 400),
    ],
)
def test_nothing_outside_the_project_is_read(page: Page, kind: str, name: str, status: int) -> None:
    for answer in (picture(page, kind, name), page.post("/api/background", {"kind": kind, "name": name})):
        assert answer.status == status
        assert not answer.body.startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("kind", "name", "place", "cause"),
    [
        ("map", "broken.yaml", "broken.yaml:4:7", "not a nav2 map: "),
        ("map", "short.yaml", "short.yaml", "not a nav2 map: it has no 'resolution'"),
        ("map", "huge.yaml", "huge.png", "the image has more than 36 megapixels"),
        ("image", "huge.png", "huge.png", "the image has more than 36 megapixels"),
        ("image", "text.png", "text.png", "the image cannot be read: not an image"),
    ],
)
def test_what_cannot_be_shown_says_place_cause_and_remedy(
    page: Page, kind: str, name: str, place: str, cause: str
) -> None:
    for answer in (picture(page, kind, name), page.post("/api/background", {"kind": kind, "name": name})):
        problem = answer.json["error"]
        assert answer.status == 422
        assert problem["place"] == place
        assert problem["message"].startswith(cause)
        assert problem["remedy"]


def test_the_path_of_a_recording_is_where_its_robot_was(page: Page) -> None:
    driven = page.post("/api/background/path", {"bag": "monday"}).json
    path = driven["path"]
    assert (driven["source"], driven["has_pose"]) == ("/odom", True)
    assert path[0] == [0, 0, 0]
    assert [(x, y) for _, x, y in path] == [(0, pytest.approx(t, abs=0.05)) for t, _, _ in path]
    assert page.post("/api/background/path", {"bag": "../monday"}).status == 403


def test_the_map_of_the_examples_is_the_demos_warehouse() -> None:
    script = runpy.run_path(str(EXAMPLES.parent / "scripts" / "make_map.py"))
    assert (EXAMPLES / "warehouse_map.yaml").read_text(encoding="utf-8") == script["header"]()
    with Image.open(EXAMPLES / "warehouse_map.png") as image:
        assert np.array_equal(np.asarray(image), np.asarray(script["picture"](warehouse())))
