"""A real browser for tests of the page: Debian's chromium, driven by playwright, drawing in software."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from io import BytesIO
from urllib.parse import urlsplit

import numpy as np
import pytest
import viser
from PIL import Image
from playwright.sync_api import Page, expect, sync_playwright

INSTALL = "sudo apt-get install -y chromium libgl1-mesa-dri"
FLAGS = ("--no-sandbox", "--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist")
"""Mesa's llvmpipe by way of EGL: twice as fast as SwiftShader, which chromium would take by itself."""
SIZE = {"width": 1280, "height": 720}
PATIENCE = 90_000
"""Longest wait for the page to change [ms]: software drawing on a busy machine."""
CHANGED = 24
"""A pixel counts as another one if a channel differs by more than this, of 255."""


@dataclass
class PageInBrowser:
    """An open page, and what it has asked the network for."""

    page: Page
    requests: list[str] = field(default_factory=list)

    def press(self, name: str) -> None:
        """Press a button once it can be pressed."""
        button = self.page.get_by_role("button", name=name, exact=True)
        expect(button).to_be_enabled(timeout=PATIENCE)
        button.click(timeout=PATIENCE)

    def choose(self, shown: str, wanted: str) -> None:
        """Choose from the list that shows an entry now."""
        self.page.locator(f'input[role=combobox][value="{shown}"]').click(timeout=PATIENCE)
        self.page.get_by_role("option", name=wanted, exact=True).click(timeout=PATIENCE)

    def can_press(self, name: str) -> bool:
        """Whether a button can be pressed now."""
        return self.page.get_by_role("button", name=name, exact=True).is_enabled()

    def wait_for_headline(self, text: str) -> None:
        """Wait until the state in large letters contains a text."""
        expect(self.page.get_by_role("status")).to_contain_text(text, timeout=PATIENCE)

    def wait_for_text(self, text: str) -> None:
        """Wait until a text can be read somewhere on the page."""
        expect(self.page.get_by_text(text).first).to_be_visible(timeout=PATIENCE)

    def wait_for_scene(self) -> None:
        """Wait until a good part of the page is not of one colour."""
        deadline = time.monotonic() + PATIENCE / 1000
        while self._drawn_share() < 0.2:
            assert time.monotonic() < deadline, "nothing was drawn"
            self.page.wait_for_timeout(200)

    def _drawn_share(self) -> float:
        """Share of the page that is not of the colour of its corner."""
        pixels = np.asarray(Image.open(BytesIO(self.page.screenshot(timeout=PATIENCE))).convert("RGB"))
        return changed_share(pixels, np.broadcast_to(pixels[0, 0], pixels.shape))

    @property
    def foreign_requests(self) -> list[str]:
        """Requests that left this machine."""
        return [url for url in self.requests if not _is_local(url)]


@contextmanager
def open_page(
    address: str, *, size: dict[str, int] | None = None, script: str = ""
) -> Iterator[PageInBrowser]:
    """The page in a browser of its own; the test is skipped where there is none.

    Args:
        address: of the page.
        size: of the window [px].
        script: runs in the page before its own.
    """
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        pytest.skip(f"needs a browser: {INSTALL}")
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium, args=list(FLAGS))
        page = browser.new_page(viewport=size or SIZE)
        shown = PageInBrowser(page)
        page.on("request", lambda request: shown.requests.append(request.url))
        page.add_init_script(script)
        page.goto(address, timeout=PATIENCE)
        try:
            yield shown
        finally:
            browser.close()


def picture(server: viser.ViserServer) -> np.ndarray:
    """What the first browser draws of the scene, `(120, 160, 3)`; software may need a second try."""
    client = next(iter(server.get_clients().values()))
    for is_last in (False, True):
        try:
            return client.get_render(120, 160, transport_format="png", timeout=30.0)[..., :3]
        except TimeoutError:
            if is_last:
                raise
    raise AssertionError


def steady_picture(server: viser.ViserServer) -> np.ndarray:
    """What the first browser draws once everything has been loaded: two pictures that are the same."""
    before = picture(server)
    for _ in range(20):
        now = picture(server)
        if changed_share(before, now) == 0.0:
            return now
        before = now
    raise AssertionError("the picture never came to rest")


def changed_share(one: np.ndarray, other: np.ndarray) -> float:
    """Share of the pixels in which two pictures differ."""
    return float((np.abs(one.astype(int) - other.astype(int)).max(axis=2) > CHANGED).mean())


def _is_local(url: str) -> bool:
    parts = urlsplit(url)
    return parts.scheme in ("blob", "data", "file") or parts.hostname in ("127.0.0.1", "localhost")
