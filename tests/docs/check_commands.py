#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command and option of heartgen that a page names is in its help: check_commands.py HEARTGEN HEARTGEN_LAB"""
import re
import sys

from page_commands import help_commands, help_of, inline_commands, page_commands, program_words, subcommands

WORD = re.compile(r"[a-z][a-z-]*$")


def is_name(word):
    return WORD.match(word) is not None


class Programs:
    """What the helps name, each asked for once."""

    def __init__(self, paths):
        self.paths = paths
        self.known = {name: subcommands(path) for name, path in paths.items()}
        self.texts = {name: {"": help_of(path)} for name, path in paths.items()}

    def text(self, program, command):
        texts = self.texts[program]
        if command not in texts:
            texts[command] = help_of(self.paths[program], command)
        return texts[""] + texts[command]


def options_of(text):
    return set(re.findall(r"(?<![\w-])--?[A-Za-z][\w-]*", text))


def problem(programs, words):
    """What is wrong with a call; None where nothing is."""
    program, *rest = words
    command = next((word for word in rest if not word.startswith("-")), "")
    if not command or not is_name(command):
        command = ""
    elif command not in programs.known[program]:
        return f"{program} has no command {command}"
    known = options_of(programs.text(program, command))
    for word in rest:
        option = word.split("=")[0]
        if re.match(r"--?[A-Za-z]", option) and option not in known:
            return f"{program} {command} has no option {option}"
    return None


def main(heartgen, heartgen_lab):
    programs = Programs({"heartgen": heartgen, "heartgen-lab": heartgen_lab})
    checked, wrong = 0, []
    for command in page_commands() + help_commands(heartgen) + inline_commands():
        text = command.text.replace("...", "").replace("…", "").replace("|", " ")
        try:
            calls = program_words(text)
        except ValueError:  # a quotation over several lines
            continue
        for words in calls:
            if words[0] not in programs.paths:
                continue
            checked += 1
            if what := problem(programs, words):
                wrong.append(f"{command.page}:{command.line}: {what}: {command.text}")
    print(*wrong, sep="\n")
    print(f"{checked} commands, {len(wrong)} wrong")
    return 1 if wrong or checked < 50 else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
