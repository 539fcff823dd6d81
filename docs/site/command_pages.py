# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of commands out of what --help prints."""
import itertools
import re
import subprocess

ENTRY = re.compile(r"^  (\S.*?)(?:\s{2,}(.*))?$")
ADDED = re.compile(r"^ {10,}(\S.*)$")


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout


def road_commands(text):
    """{heading: [(command, what it does)]} of the program's help."""
    roads = {}
    for block in text.split("\n\n"):
        heading, *lines = block.strip().splitlines() or [""]
        if heading.startswith("You have"):
            roads[heading.rstrip(":")] = [ENTRY.match(line).groups() for line in lines]
    return roads


def entries(lines):
    """[[name, meaning]] of a section of the help; a meaning may stand on the lines below its name."""
    found = []
    for line in lines:
        if added := ADDED.match(line):
            found[-1][1] = " ".join(filter(None, [found[-1][1], added[1]]))
        else:
            name, meaning = ENTRY.match(line).groups()
            found.append([name, meaning or ""])
    return found


def sections(text):
    """The usage, {"Positionals": lines, "Options": lines}, and the notes at the end of a command's help."""
    lines = text.rstrip().splitlines()
    usage = next(line for line in lines if line.startswith("Usage: "))[len("Usage: "):]
    found, current = {}, None
    for at, line in enumerate(lines):
        if line in ("Positionals:", "Options:"):
            current = found.setdefault(line.rstrip(":"), [])
        elif current is not None and line.startswith("  "):
            current.append(line)
        elif current is not None and line:
            return usage, found, lines[at:]
    return usage, found, []


def cell(text):
    return re.sub(r"([|<*_`\[])", r"\\\1", text)


def option_table(title, rows):
    lines = [f"## {title}", "", "| | |", "|---|---|"]
    for name, meaning in rows:
        required = " (required)" if name.endswith(" REQUIRED") else ""
        lines.append(f"| `{name.removesuffix(' REQUIRED')}`{required} | {cell(meaning)} |")
    return lines + [""]


def note_blocks(notes):
    """Examples as commands, the rest as it stands."""
    def kind(line):
        if not line.startswith(" "):
            return "words"
        return "sh" if re.match(r"  (heartgen|mpirun|\()", line) else "text"

    blocks = []
    for what, group in itertools.groupby(notes, kind):
        lines = list(group)
        if what == "words":
            blocks += [cell(" ".join(lines)), ""]
        else:
            blocks += ["```" + what, *[re.sub(r"^\((.*)\)$", r"# \1", line[2:]) for line in lines], "```", ""]
    return blocks


def command_page(name, text):
    usage, tables, notes = sections(text)
    lines = [f"# heartgen {name}", "", cell(text.splitlines()[0]) + ".", "", "```text", usage, "```", ""]
    for title, heading in (("Positionals", "Arguments"), ("Options", "Options")):
        if title in tables:
            lines += option_table(heading, entries(tables[title]))
    if notes:
        lines += ["## Notes and examples", "", *note_blocks(notes)]
    return "\n".join(lines).rstrip() + "\n"


def index_page(text, roads):
    lines = ["# Commands", "", "What `heartgen --help` prints, a page for each command.", ""]
    for road, commands in roads.items():
        lines += [f"## {road}", "", "| | |", "|---|---|"]
        lines += [f"| [`{name}`]({name}.md) | {cell(meaning)} |" for name, meaning in commands] + [""]
    lines += option_table("Options of all commands", entries(sections(text)[1]["Options"]))
    lines += ["## Exit codes", "", "0: done. 1: a defect of heartgen. 2: a mistake in what was given, or what the machine "
              "lacks; one line says what, where and what to do. 3: a check failed. 129, 130, 143: ended by a signal."]
    return "\n".join(lines) + "\n"


def write_command_pages(program, pages):
    """Writes docs/commands/*.md and returns their part of the navigation."""
    folder = pages / "docs/commands"
    folder.mkdir(parents=True)
    text = help_of(program)
    roads = road_commands(text)
    (folder / "README.md").write_text(index_page(text, roads), encoding="utf-8")
    navigation = ["docs/commands/README.md"]
    for road, commands in roads.items():
        for name, _ in commands:
            (folder / f"{name}.md").write_text(command_page(name, help_of(program, name)), encoding="utf-8")
        navigation.append({road: [{name: f"docs/commands/{name}.md"} for name, _ in commands]})
    return navigation
