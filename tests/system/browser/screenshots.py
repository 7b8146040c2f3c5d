#!/usr/bin/env python3
"""Makes the pictures of the page's four views in deploy/images, of the laboratory that is played.

    screenshots.py [FOLDER]
"""

import pathlib
import sys

import chromium
import page_case
from played_laboratory import TOP, PlayedServer, example

MAX_BYTES = 200_000
# Name, address, height, what is to be there, dark.
PICTURES = [
    ("laboratory", "", 960, "document.querySelectorAll('.tile').length === 3", False),
    ("bench", "bench/acc-1", 900,
     "document.querySelector('[data-field=spectrum]').textContent !== ''", False),
    ("run", "run/acc-2", 960, "document.querySelectorAll('[data-step]').length === 51", False),
    ("history", "history", 860, "document.querySelectorAll('[data-panel=en] tr').length > 30",
     True),
]
DRAWN = ("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => "
         "setTimeout(done, 300))))")


def main():
    reason = page_case.missing()
    if reason:
        print(f"skipped: {reason}")
        sys.exit(page_case.SKIPPED)
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else TOP / "deploy/images"
    folder.mkdir(parents=True, exist_ok=True)
    server = PlayedServer(example())
    with chromium.Chromium() as browser:
        for name, view, height, ready, dark in PICTURES:
            page = browser.page(f"{server.address}#/{view}", 1280, height, dark)
            page.wait_for(page_case.connection_is("live"))
            page.wait_for(ready)
            page.value(DRAWN)
            path = folder / f"page-{name}.png"
            page.picture(path, whole=False)
            page.close()
            size = path.stat().st_size
            print(f"{path}: {size} bytes")
            if size > MAX_BYTES:
                sys.exit(f"{path} is larger than {MAX_BYTES} bytes")
    server.stop()


if __name__ == "__main__":
    main()
