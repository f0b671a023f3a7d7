"""Takes a screenshot of a page in a browser.

usage: page_picture.py PAGE PICTURE.png [--width N] [--height N] [--dark] [--run SCRIPT]

--height 0 takes the whole page. --run runs JavaScript first, such as a click on a control. Needs the Debian packages
chromium, chromium-driver and python3-selenium.
"""

import argparse
import os
import shutil
import tempfile
import time


def open_browser(profile):
    """Chromium without a window or network, rendering on the CPU; `profile` is a new folder."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    flags = ["headless", "no-sandbox", "disable-dev-shm-usage", "use-gl=angle", "use-angle=swiftshader"]
    flags += ["enable-unsafe-swiftshader", "disable-quic", "no-first-run", "disable-background-networking"]
    flags += ["disable-component-update", "disable-sync", "hide-scrollbars", f"user-data-dir={profile}"]
    for flag in flags:
        options.add_argument("--" + flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))


def set_window(browser, width, height, dark=False):
    """Size in pixels, and whether the page is shown in its dark theme."""
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
        "features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                            {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})


def main():
    parser = argparse.ArgumentParser(description="Takes a screenshot of a page in a browser.")
    parser.add_argument("page")
    parser.add_argument("picture")
    parser.add_argument("--width", type=int, default=1180)
    parser.add_argument("--height", type=int, default=900)
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--run", default="")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as profile:
        browser = open_browser(profile)
        try:
            set_window(browser, arguments.width, arguments.height or 900, arguments.dark)
            browser.get("file://" + os.path.abspath(arguments.page))
            browser.execute_script(arguments.run)
            if arguments.height == 0:
                whole = browser.execute_script("return document.documentElement.scrollHeight")
                set_window(browser, arguments.width, whole, arguments.dark)
            time.sleep(1)  # until it is drawn
            browser.save_screenshot(arguments.picture)
        finally:
            browser.quit()


if __name__ == "__main__":
    main()
