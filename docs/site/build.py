#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the documentation site: build.py HEARTGEN DEFAULT_RECIPE OUTPUT

HEARTGEN is the program, whose help becomes the pages of commands; DEFAULT_RECIPE prints every setting. OUTPUT gets
pages/, what mkdocs reads, and html/, the site: static, from disk, without a network, the same bytes every time.
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import yaml

from command_pages import write_command_pages
from python_page import write_python_page
from recipe_page import write_recipe_page

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
KATEX = Path("/usr/share/javascript/katex")

LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)\s]*)?\)")
INCLUDE = re.compile(r"^\[[^\]]*\]\(([^)]*exporters/decks/[^)]+)\)$", re.MULTILINE)
LANGUAGES = {".py": "python", ".xml": "xml", ".feb": "xml", ".md": "text"}


def sources():
    """The pages of the repository."""
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", ROOT / "benchmarks/backends.md",
            *sorted((ROOT / "docs").rglob("*.md"))]


def deck_text(path):
    """A file of exporters/decks as a part of a page: its README in place, an input folded away."""
    text = path.read_text(encoding="utf-8").replace("{{mesh}}", "myocardium").rstrip()
    if path.name == "README.md":
        return text.replace("{{stimulus_domain}}", "30")
    name = path.name.replace("NAME", "myocardium")
    language = LANGUAGES.get(path.suffix, "text")
    block = f"``` {language}\n{text}\n```"
    return f'??? example "`{name}`, before its places in braces are filled in"\n\n' + re.sub("^(?=.)", "    ", block, flags=re.M)


def lay_out(pages):
    """Pages, and the files that they show or name, where they lie in the repository."""
    for source in sources():
        text = source.read_text(encoding="utf-8")
        page = pages / source.relative_to(ROOT)
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(INCLUDE.sub(lambda found: deck_text(source.parent / found[1]), text), encoding="utf-8")
        for name in LINK.findall(INCLUDE.sub("", text)):
            file = (source.parent / name).resolve()
            if ":" in name or file.suffix == ".md" or not file.is_file():
                continue
            copy = pages / file.relative_to(ROOT)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy)


def public_headers():
    """include/heartgen, and what it includes: what a program sees."""
    found, wanted = set(), sorted((ROOT / "include/heartgen").glob("*.hpp"))
    while wanted:
        header = wanted.pop()
        if header in found:
            continue
        found.add(header)
        names = re.findall(r'^#include "([^"]+)"', header.read_text(encoding="utf-8"), re.MULTILINE)
        wanted += [ROOT / name for name in names if (ROOT / name).is_file()]
    return [str(header.relative_to(ROOT)) for header in sorted(found)]


def write_cpp_pages(output, folder):
    folder.mkdir(parents=True, exist_ok=True)
    places = {"HEARTGEN_HEADERS": " ".join(public_headers()), "HEARTGEN_DOCS": str(folder.parent)}
    subprocess.run(["doxygen", "docs/Doxyfile"], cwd=ROOT, check=True, env={**os.environ, **places})
    shutil.move(folder.parent / "doxygen_warnings.txt", output / "doxygen_warnings.txt")


def copy_katex(folder):
    (folder / "fonts").mkdir(parents=True)
    for name in ("katex.min.js", "katex.min.css"):
        shutil.copyfile(KATEX / name, folder / name)
    for font in sorted((KATEX / "fonts").glob("*.woff2")):
        shutil.copyfile(font, folder / "fonts" / font.name)
    css = folder / "katex.min.css"  # every browser that renders the site reads woff2
    css.write_text(re.sub(r',url\([^)]*\.(?:woff|ttf)\) format\("[a-z]+"\)', "", css.read_text()))


def write_configuration(output, commands):
    text = (HERE / "mkdocs.yml").read_text(encoding="utf-8")
    configuration = yaml.safe_load(text)
    configuration["theme"]["custom_dir"] = str(HERE / "theme")
    next(entry for entry in configuration["nav"] if "Commands" in entry)["Commands"] = commands
    (output / "mkdocs.yml").write_text(yaml.safe_dump(configuration, sort_keys=False), encoding="utf-8")


def finish(html):
    """What mkdocs writes with a date goes; the search index becomes a script, which pages from disk may load."""
    for name in ("sitemap.xml", "sitemap.xml.gz"):
        (html / name).unlink(missing_ok=True)
    index = html / "search/search_index.json"
    text = index.read_text(encoding="utf-8")
    (html / "search/search_index.js").write_text(f"var __search = {{index: Promise.resolve({text})}};\n", encoding="utf-8")
    index.unlink()


def main(heartgen, default_recipe, output):
    output = Path(output).resolve()
    pages, html = output / "pages", output / "html"
    shutil.rmtree(pages, ignore_errors=True)
    shutil.rmtree(html, ignore_errors=True)
    lay_out(pages)
    commands = write_command_pages(heartgen, pages)
    write_recipe_page(default_recipe, ROOT / "model/recipe.hpp", pages / "docs/recipe.md")
    write_python_page(ROOT / "python/heartgen", pages / "docs/python_api.md")
    copy_katex(pages / "site/katex")
    write_cpp_pages(output, pages / "site/cpp")
    write_configuration(output, commands)
    epoch = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True).stdout.strip()
    subprocess.run(["mkdocs", "build", "--quiet", "--strict", "--config-file", output / "mkdocs.yml"], check=True,
                   env={"SOURCE_DATE_EPOCH": epoch or "0", **os.environ})
    finish(html)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
