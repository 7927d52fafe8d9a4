"""Chromium without a window, driven by Selenium (Debian's packages chromium and chromium-driver)."""

from __future__ import annotations

import json
import shutil

import pytest

FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-dev-shm-usage"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
)
CHROMIUM, DRIVER = (shutil.which(name) for name in ("chromium", "chromedriver"))
DESKTOP, PHONE = (1280, 900), (390, 844)
needs_browser = pytest.mark.skipif(CHROMIUM is None or DRIVER is None, reason="needs chromium and chromedriver")


def start_browser(profile):
    """Return a browser, whose requests and errors `complaints` reports."""
    selenium = pytest.importorskip("selenium.webdriver")
    options = selenium.ChromeOptions()
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.binary_location = CHROMIUM
    options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
    driver = selenium.Chrome(options=options, service=selenium.ChromeService(DRIVER))
    driver.set_script_timeout(30)
    # The page of a new tab asks other hosts: leave it before requests are watched.
    driver.get("about:blank")
    return driver


def complaints(browser, address):
    """Return console errors, failed requests, and requests to any other host since the last call."""
    found = [entry["message"] for entry in browser.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    for entry in browser.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        parameters = message["params"]
        if message["method"] == "Network.loadingFailed" and not parameters.get("canceled"):
            found.append(f"failed: {parameters}")
        if message["method"] == "Network.responseReceived" and parameters["response"]["status"] >= 400:
            found.append(f"{parameters['response']['status']}: {parameters['response']['url']}")
        if message["method"] == "Network.requestWillBeSent":
            url = parameters["request"]["url"]
            if not url.startswith((address, "data:", "blob:", "about:", "chrome")):
                found.append(f"outside: {url}")
    return found
