"""A real browser without a window, driven over HTTP by its own driver (W3C WebDriver): Debian's chromium-driver."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
import urllib.request
from pathlib import Path
from types import TracebackType
from typing import Any

DRIVER = shutil.which("chromedriver")
# Containers offer no sandbox and little shared memory.
ARGUMENTS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"]


class Browser:
    """Session of a browser, used in a `with` block."""

    def __init__(self) -> None:
        assert DRIVER is not None
        self._driver = subprocess.Popen([DRIVER, "--port=0"], stdout=subprocess.PIPE, text=True)
        self._session = ""

    def __enter__(self) -> Browser:
        assert self._driver.stdout is not None
        started = next(m for line in self._driver.stdout if (m := re.search(r"successfully on port (\d+)", line)))
        self._root = f"http://127.0.0.1:{started[1]}"
        wanted = {"goog:chromeOptions": {"args": ARGUMENTS}, "goog:loggingPrefs": {"browser": "SEVERE"}}
        self._session = self._post("/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        try:
            if self._session:
                self._ask("DELETE", f"/session/{self._session}", None)
        finally:
            self._driver.terminate()
            self._driver.wait()

    def open(self, page: Path, width: int, height: int = 900) -> None:
        """Show a file in a window of this size (px)."""
        self.resize(width, height)
        self._post(f"/session/{self._session}/url", {"url": page.resolve().as_uri()})

    def resize(self, width: int, height: int = 900) -> None:
        """Change the size of the window (px)."""
        self.tell("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def media(self, medium: str = "", **features: str) -> None:
        """Emulate a medium such as `print`, and media features such as prefers_color_scheme."""
        wanted = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
        self.tell("Emulation.setEmulatedMedia", media=medium, features=wanted)

    def run(self, script: str) -> Any:
        """Run the body of a JavaScript function in the page; return its value."""
        return self._post(f"/session/{self._session}/execute/sync", {"script": script, "args": []})

    def faults(self) -> list[str]:
        """Error messages of scripts and of the browser since the last call."""
        entries = self._post(f"/session/{self._session}/se/log", {"type": "browser"})
        return [str(entry["message"]) for entry in entries]

    def pdf(self) -> bytes:
        """Return the printed page as PDF."""
        return base64.b64decode(self.tell("Page.printToPDF", printBackground=True)["data"])

    def tell(self, command: str, **parameters: Any) -> Any:
        """Send a command of the Chrome DevTools protocol; return its result."""
        return self._post(f"/session/{self._session}/goog/cdp/execute", {"cmd": command, "params": parameters})

    def _post(self, path: str, content: dict[str, Any]) -> Any:
        return self._ask("POST", path, json.dumps(content).encode())

    def _ask(self, method: str, path: str, content: bytes | None) -> Any:
        request = urllib.request.Request(
            self._root + path, content, {"Content-Type": "application/json"}, method=method
        )
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # the driver is on this machine
        with opener.open(request, timeout=60) as answer:
            return json.load(answer)["value"]
