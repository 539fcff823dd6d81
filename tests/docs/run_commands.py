#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs every command of the documentation: run_commands.py HEARTGEN [PAGE...]

A page's commands run from top to bottom in a folder of their own, which holds the files that pages name (phantom_world).
What would take long is made coarse, and nothing else is changed: `coarse` says how. Commands of other programs run where
the program is installed. What is not run is counted and listed with its reason, which the page gives in a comment
`<!-- not run: REASON -->` before the block. Exit code 0: all that ran ended well.
"""
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from page_commands import help_commands, page_commands, program_words
from phantom_world import MESH, SIZE, make_world

# Of these the tests of the project run each in its own way, or nobody should.
LEFT = {"make": "builds the tree", "cmake": "builds the tree", "ctest": "runs the tests", "sudo": "changes the machine",
        "heartgen-lab": "takes minutes to hours; tests/lab runs it on less", "tar": "needs a release",
        "export": "sets up a shell"}
CHECKS = {"build", "validate", "mesh", "landmarks"}  # may end with 3: coarse voxels cost checks, the output is there
SHOWN = 25  # lines of what failed


def reason_to_leave(command):
    """Why a command is not run; empty: it is run."""
    if command.reason:
        return command.reason
    for program, *_ in program_words(command.text):
        if program in LEFT:
            return f"{program} {LEFT[program]}"
        if not shutil.which(program):
            return f"{Path(program).name} is not installed"
    return ""


def coarse_recipe(folder, words):
    """The recipe of a build, with long edges; a build without one gets one."""
    named = [word for word in words[2:] if word.endswith(".toml")]
    if not named:
        return words[:2] + ["coarse.toml"] + words[2:]
    recipe = folder / named[0]
    text = recipe.read_text(encoding="utf-8")
    if "heart_edge_mm" not in text:
        recipe.unlink()  # it may be a link to the world's
        recipe.write_text(text + MESH, encoding="utf-8")
    return words


def with_option(words, option, value):
    """The words with the option's value replaced where it is given."""
    return words if option not in words else [*words[:words.index(option) + 1], value, *words[words.index(option) + 2:]]


def coarse(folder, words):
    """A heavy command made light; an older output of a build goes first."""
    if words[:2] == ["heartgen", "build"]:
        for option in ("-o", "--output"):
            if option in words:
                shutil.rmtree(folder / words[words.index(option) + 1], ignore_errors=True)
        return coarse_recipe(folder, words)
    if words[:2] == ["heartgen", "phantom"]:
        shutil.rmtree(folder / words[2], ignore_errors=True)
        given = [word for at, word in enumerate(words) if not {"--size", "--spacing"} & {word, words[at - 1]}]
        return given + SIZE
    if words[:2] == ["heartgen", "mesh"]:
        words = with_option(words, "--edge", "5")
        return words if "--edge" in words else [*words, "--edge", "5"]
    return words


def run(folder, command):
    """(exit code, what it said, seconds)."""
    text = command.text
    words = shlex.split(text)
    launched = words[:3] if words[0] == "mpirun" else []
    if words[len(launched)] == "heartgen":
        text = shlex.join(launched + coarse(folder, words[len(launched):]))
    begin = time.monotonic()
    done = subprocess.run(["bash", "-c", text], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace")
    return done.returncode, done.stdout, time.monotonic() - begin


def is_well(command, code):
    calls = program_words(command.text)
    return code == 0 or (code == 3 and any(words[0] == "heartgen" and words[1] in CHECKS for words in calls))


def run_page(page, commands, world, scratch):
    """Exit codes that are not well, as texts; prints a line per command."""
    folder = scratch / re.sub(r"\W+", "_", page)
    shutil.copytree(world, folder, copy_function=os.link)
    failures = []
    for command in commands:
        code, said, seconds = run(folder, command)
        well = is_well(command, code)
        print(f"{'ok  ' if well else 'FAIL'} {code} {seconds:6.1f} s  {page}:{command.line}: {command.text}", flush=True)
        if not well:
            failures.append("\n".join([f"{page}:{command.line}: {command.text}", *said.splitlines()[-SHOWN:]]))
    shutil.rmtree(folder)
    return failures


def environment(heartgen):
    """The program first in the path; MPI as root and on few processors; OpenFOAM's own folder."""
    os.environ.update({"PATH": f"{Path(heartgen).resolve().parent}:/usr/bin:{os.environ['PATH']}",
                       "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                       "OMPI_MCA_rmaps_base_oversubscribe": "1", "WM_PROJECT_DIR": "/usr/share/openfoam"})


def main(heartgen, only):
    environment(heartgen)
    commands = [command for command in page_commands() + help_commands(heartgen) if not only or command.page in only]
    left = [(command, why) for command in commands if (why := reason_to_leave(command))]
    wanted = [command for command in commands if command not in {command for command, _ in left}]
    failures, begin = [], time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        world = Path(name) / "world"
        world.mkdir()
        make_world(world)
        print(f"the files that pages name: {time.monotonic() - begin:.0f} s", flush=True)
        for page in dict.fromkeys(command.page for command in wanted):
            failures += run_page(page, [command for command in wanted if command.page == page], world, Path(name))
    for command, why in left:
        print(f"not run  {command.page}:{command.line}: {command.text}  ({why})")
    for failure in failures:
        print(f"\nFAILED {failure}")
    reasons = Counter(why for _, why in left)
    print(f"\n{len(wanted)} commands run in {time.monotonic() - begin:.0f} s, {len(failures)} failed; {len(left)} not run:")
    print(*(f"  {count}: {why}" for why, count in sorted(reasons.items())), sep="\n")
    return 1 if failures or not wanted else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
