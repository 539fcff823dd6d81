# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands that the pages of the documentation name, and those of the examples in --help."""
import re
import shlex
import subprocess
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
REASON = re.compile(r"<!-- not run: (.*?) -->")
FENCE = re.compile(r"^ *```\s*(\w*)")
INLINE = re.compile(r"`(heartgen(?:-lab)? [^`]*)`")


@dataclass(frozen=True)
class Command:
    page: str
    line: int
    text: str  #: as a shell reads it, without its comment
    reason: str  #: why it is not run; empty: it is


def pages():
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


def without_comment(line):
    """The line up to a # that begins a comment."""
    return re.split(r"(?:^|\s)#\s", line, maxsplit=1)[0].strip()


def commands_of(name, text):
    """Lines of the blocks in sh, with the reason that stands before their block."""
    found, language, reason = [], None, ""
    for number, line in enumerate(text.splitlines(), 1):
        if fence := FENCE.match(line):
            if language is not None:
                language, reason = None, ""
            else:
                language = fence[1]
        elif language == "sh" and (command := without_comment(line)):
            found.append(Command(name, number, command.removeprefix("$ "), reason))
        elif language is None and (why := REASON.search(line)):
            reason = why[1]
        elif language is None and line.strip():
            reason = ""
    return found


def page_commands():
    return [command for page in pages()
            for command in commands_of(str(page.relative_to(ROOT)), page.read_text(encoding="utf-8"))]


def inline_commands():
    """Commands in running text: `heartgen build --force`."""
    found = []
    for page in pages():
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            found += [Command(str(page.relative_to(ROOT)), number, text, "") for text in INLINE.findall(line)]
    return found


def help_of(program, *words):
    return subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout


def subcommands(program):
    return re.findall(r"^  ([a-z][a-z-]*) {2,}", help_of(program), re.MULTILINE)


def help_commands(program):
    """The examples at the end of each command's help."""
    found = []
    for name in subcommands(program):
        for number, line in enumerate(help_of(program, name).splitlines(), 1):
            if line.startswith("  heartgen "):
                found.append(Command(f"heartgen {name} --help", number, line.strip(), ""))
    return found


def program_words(text):
    """[[program, argument...]] of a line that may hold `cd FOLDER &&`, mpirun and brackets."""
    parts = [part for part in re.split(r"&&|;|\(|\)", text) if part.strip()]
    calls = [shlex.split(part) for part in parts]
    return [words[3:] if words[:2] == ["mpirun", "-n"] else words for words in calls if words and words[0] != "cd"]
