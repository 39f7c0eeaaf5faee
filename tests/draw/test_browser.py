"""Pages in a real browser: the viewer, the report and the site of the docs. It needs Debian's package chromium, and playwright."""

from __future__ import annotations

import re
import shutil
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from hymeko_x import api
from hymeko_x.cli import exits, main

ROOT = Path(__file__).parents[2]
CHROMIUM = shutil.which("chromium")
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",  # WebGL without a graphics card
    "--enable-unsafe-swiftshader",
]
PANEL = 320
"""The width of the viewer's column at the right, in pixels."""
SECOND = 1000.0
"""Playwright counts in ms."""

ARM = """<robot name="arm">
  <link name="base"><visual><geometry><cylinder radius="0.1" length="0.2"/></geometry></visual></link>
  <link name="fore"><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.08 0.08"/></geometry></visual></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="fore"/><origin xyz="0 0 0.14"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""
FRAMES = """() => new Promise(done => {
    let count = 0;
    const start = performance.now();
    const step = now => { count += 1; if (now - start < 3000) requestAnimationFrame(step); else done(1000 * count / (now - start)); };
    requestAnimationFrame(step);
})"""
"""JavaScript: how many frames the page draws in a second, measured for three."""

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium (apt-get install chromium)")


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    sync_api = pytest.importorskip("playwright.sync_api", reason="there is no playwright (pip install playwright)")
    with sync_api.sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture
def open_page(browser: Any) -> Iterator[Callable[..., Any]]:
    """Opens an address, and fails at the end where the page has reported an error."""
    errors: list[str] = []
    pages = []

    def opened(address: str, width: int = 900, height: int = 480) -> Any:
        page = browser.new_page(viewport={"width": width, "height": height})
        page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("requestfailed", lambda request: None if "ABORTED" in request.failure else errors.append(request.url))  # the next page came
        pages.append(page)
        page.goto(address)
        return page

    yield opened
    for page in pages:
        page.close()
    assert errors == []


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., str]]:
    """Starts `hymeko-x view` with files of ``tmp_path``; the address that it prints."""
    servers = []

    def served(*files: str) -> str:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        words = [sys.executable, "-m", "hymeko_x", "view", *files, "--port", str(port), "--samples", "5", "--no-meshes"]
        servers.append(subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, text=True))
        return servers[-1].stdout.readline().strip()

    yield served
    for server in servers:
        server.terminate()
        server.communicate()


@contextmanager
def served_folder(folder: Path) -> Iterator[str]:
    """The address at which a folder is served."""

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *words: object) -> None:
            """Nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(folder))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def picture(page: Any) -> np.ndarray:
    """What is left of the viewer's column, (rows, columns, 3)."""
    size = page.viewport_size
    clip = {"x": 0, "y": 0, "width": size["width"] - PANEL - 8, "height": size["height"]}
    return np.array(Image.open(BytesIO(page.screenshot(clip=clip))).convert("RGB")).astype(int)


def settled(page: Any) -> np.ndarray:
    """The picture when it no longer changes."""
    last = picture(page)
    for _ in range(20):
        now = picture(page)
        if (np.abs(now - last) > 8).any(axis=2).mean() < 1e-3:
            return now
        last = now
    raise AssertionError("the picture goes on changing")


def red(image: np.ndarray) -> np.ndarray:
    """Where a picture is red, (rows, columns)."""
    return (image[..., 0] > 120) & (image[..., 0] > 2 * image[..., 1]) & (image[..., 0] > 2 * image[..., 2])


def spots(mask: np.ndarray) -> list[int]:
    """The sizes of marked places of at least 300 pixels with unmarked columns between them, from left to right."""
    columns = np.flatnonzero(mask.any(axis=0))
    groups = np.split(columns, np.flatnonzero(np.diff(columns) > 5) + 1)
    return [size for group in groups if (size := int(mask[:, group].sum())) >= 300]


def hide_note(page: Any) -> None:
    """Hide viser's note that there is no graphics card."""
    page.add_style_tag(content=".mantine-Notification-root { display: none }")


# ---- the viewer ----------------------------------------------------------------------------------------------------------------


@pytest.mark.full
def test_a_slider_moves_both_robots_and_nothing_else(open_page: Callable[..., Any], serve: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "arm.xml").write_text(api.dumps(api.loads(ARM, "urdf").mechanism, "mjcf"))
    page = open_page(serve("arm.urdf", "arm.xml"))
    page.get_by_text(re.compile("^same")).wait_for(timeout=60 * SECOND)
    hide_note(page)
    before = settled(page)
    slider = page.get_by_role("slider")
    slider.scroll_into_view_if_needed()
    thumb = slider.bounding_box()
    page.mouse.click(thumb["x"] + 50, thumb["y"] + thumb["height"] / 2)  # on the track; the keys with arrows move the camera as well
    page.wait_for_function("document.querySelector('[role=slider]').getAttribute('aria-valuenow') > 0.3", timeout=20 * SECOND)
    changed = (np.abs(settled(page) - before) > 8).any(axis=2)
    assert len(spots(changed)) == 2, spots(changed)
    assert changed.mean() < 0.3, "camera, ground and background stay"


@pytest.mark.full
def test_a_moved_link_is_red_and_named(open_page: Callable[..., Any], serve: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "a.urdf").write_text(ARM)
    (tmp_path / "b.urdf").write_text(ARM.replace("0 0 0.14", "0.1 0 0.14"))
    page = open_page(serve("a.urdf", "b.urdf"))
    button = page.get_by_role("button", name="body 'fore': forward kinematics, position 0.1 m")
    button.wait_for(timeout=60 * SECOND)
    hide_note(page)
    before = settled(page)
    assert len(spots(red(before))) == 2, spots(red(before))
    button.dispatch_event("click")
    page.wait_for_timeout(SECOND)
    assert (np.abs(settled(page) - before) > 8).any(axis=2).mean() > 0.1, "the camera flies there"


@pytest.mark.full
def test_an_edited_file_changes_the_page_within_two_seconds(
    open_page: Callable[..., Any], serve: Callable[..., str], tmp_path: Path
) -> None:
    (tmp_path / "arm.urdf").write_text(ARM)
    page = open_page(serve("arm.urdf"))
    slider = page.get_by_role("slider")
    slider.wait_for(timeout=60 * SECOND)
    (tmp_path / "arm.urdf").write_text(ARM.replace('upper="1"', 'upper="2"'))
    page.wait_for_function("document.querySelector('[role=slider]').getAttribute('aria-valuemax') == 2", timeout=2 * SECOND)
    (tmp_path / "arm.urdf").write_text("<robot name='arm'><link name='<b>'")
    page.get_by_text(re.compile("arm.urdf:.*error")).wait_for(timeout=2 * SECOND)
    (tmp_path / "arm.urdf").write_text(ARM)
    page.get_by_text(re.compile("arm.urdf:.*error")).wait_for(state="detached", timeout=2 * SECOND)


@pytest.mark.full
def test_a_file_that_is_dropped_on_the_page_is_compared(open_page: Callable[..., Any], serve: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(ARM)
    page = open_page(serve("arm.urdf"))
    page.get_by_role("slider").wait_for(timeout=60 * SECOND)
    transfer = page.evaluate_handle(
        "text => { const all = new DataTransfer(); all.items.add(new File([text], 'moved.urdf')); return all; }",
        ARM.replace("0 0 0.14", "0.1 0 0.14"),
    )
    page.dispatch_event("canvas", "drop", {"dataTransfer": transfer})
    page.get_by_role("button", name="body 'fore': forward kinematics, position 0.1 m").wait_for(timeout=60 * SECOND)


@pytest.mark.full
def test_sixty_links_move_at_twenty_frames_a_second(open_page: Callable[..., Any], serve: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "chain.urdf").write_text(chain(60))
    page = open_page(serve("chain.urdf"), width=640, height=240)
    slider = page.get_by_role("slider").first
    slider.wait_for(timeout=60 * SECOND)
    page.evaluate("""() => { let value = 1; setInterval(() => {
        const slider = document.querySelector('[role=slider]');
        slider.dispatchEvent(new KeyboardEvent('keydown', {key: (value = -value) > 0 ? 'ArrowLeft' : 'ArrowRight', bubbles: true}));
    }, 50); }""")
    rates = [page.evaluate(FRAMES) for _ in range(3)]
    assert max(rates) >= 20.0, rates


def chain(links: int) -> str:
    """Links of 0.1 m with a joint between each two."""
    link = (
        '<link name="l{0}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        '<visual><origin xyz="0 0 0.05"/><geometry><box size="0.03 0.03 0.1"/></geometry></visual></link>'
    )
    joint = (
        '<joint name="j{1}" type="revolute"><parent link="l{0}"/><child link="l{1}"/><origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>'
        '<limit lower="-0.3" upper="0.3" effort="1" velocity="1"/></joint>'
    )
    body = [link.format(number) for number in range(links)] + [joint.format(number - 1, number) for number in range(1, links)]
    return f'<robot name="chain">{"".join(body)}</robot>'


# ---- pages that are files --------------------------------------------------------------------------------------------------------


def test_the_report_opens_without_an_error_and_fits_a_phone(
    open_page: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.urdf").write_text(ARM)
    Path("b.urdf").write_text(ARM.replace("0 0 0.14", "0.1 0 0.14"))
    words = ["report", "a.urdf", "b.urdf", "-o", "page.html", "--samples", "5", "--no-meshes", "--size", "160x120", "-q"]
    assert main(words) == exits.DIFFERENT
    page = open_page((tmp_path / "page.html").as_uri(), width=390, height=844)
    assert page.get_by_text("forward kinematics, position").first.is_visible()
    assert page.evaluate("[...document.images].every(image => image.naturalWidth > 0)")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


@pytest.mark.full
def test_the_site_opens_without_an_error_and_fits_a_phone(open_page: Callable[..., Any], tmp_path: Path) -> None:
    pytest.importorskip("material")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(tmp_path / "site")]
    subprocess.run(command, cwd=ROOT, check=True)
    with served_folder(tmp_path / "site") as address:
        paths = sorted(path.relative_to(tmp_path / "site").parent.as_posix() for path in (tmp_path / "site").rglob("index.html"))
        page = open_page(address, width=390, height=844)
        wide = []
        for path in paths:
            page.goto(f"{address}{path}/")
            if page.evaluate("document.documentElement.scrollWidth") > 390:
                wide.append(path)
        assert wide == []
        page.goto(address)
        page.set_viewport_size({"width": 1280, "height": 800})
        page.locator("input[name=query]").click()
        page.keyboard.type("mimic")
        page.locator(".md-search-result__item").first.wait_for(timeout=20 * SECOND)
        assert "questions/" in page.locator("a.md-search-result__link").first.get_attribute("href")
