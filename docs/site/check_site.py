#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks a site: check_site.py FOLDER

Every link leads to a file of the site, and to a place that is in it; no page and no style loads anything from a network.
"""
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADS = {"script": "src", "img": "src", "iframe": "src", "source": "src", "video": "src", "audio": "src", "embed": "src",
         "object": "data", "image": "href", "use": "href"}
LOADING_LINKS = {"stylesheet", "icon", "shortcut", "preload", "prefetch", "preconnect", "dns-prefetch", "modulepreload"}


class Page(HTMLParser):
    """What a page names: places in it, links, and what it loads."""

    def __init__(self, text):
        super().__init__()
        self.places, self.links, self.loads = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = {name: value or "" for name, value in attributes}
        self.places.update(values[name] for name in ("id", "name") if name in values)
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        if tag == "link" and LOADING_LINKS & set(values.get("rel", "").split()):
            self.loads.append(values.get("href", ""))
        if LOADS.get(tag) in values:
            self.loads.append(values[LOADS[tag]])


def is_far(address):
    return bool(urlsplit(address).scheme) or address.startswith("//")


def target(page, address, site):
    path = unquote(urlsplit(address).path)
    place = (page.parent / path).resolve() if path and not path.startswith("/") else page
    return site / path.lstrip("/") if path.startswith("/") else place


def problems(site):
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    for path, page in pages.items():
        where = path.relative_to(site)
        for address in page.loads:
            if is_far(address) and not address.startswith(("data:", "javascript:")):
                yield f"{where}: loads {address}"
        for address in page.links + page.loads:
            if is_far(address) or path.name == "404.html":
                continue
            file = target(path, address, site)
            if not file.exists():
                yield f"{where}: {address} leads nowhere"
            fragment = unquote(urlsplit(address).fragment)
            if fragment and file in pages and fragment not in pages[file].places:
                yield f"{where}: no place {address}"
    for path in sorted(site.rglob("*.css")):
        for address in re.findall(r"url\(['\"]?([^'\")]+)", path.read_text(encoding="utf-8")):
            if is_far(address) and not address.startswith(("data:", "javascript:")):
                yield f"{path.relative_to(site)}: loads {address}"


def main(folder):
    site = Path(folder).resolve()
    found = list(problems(site))
    print(*found, sep="\n")
    print(f"{len(list(site.rglob('*.html')))} pages, {len(found)} problems")
    return 1 if found else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
