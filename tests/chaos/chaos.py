#!/usr/bin/env python3
"""What a build leaves when it is killed, or when room, rights or memory run out.

Over an older bundle a newer one is built and stopped. After that the older one must be there whole, or the newer one;
the next build must end well, with nothing else left beside it. Images are written over older ones and killed likewise.
Prints a table of what was tried, held and failed; exits with 1 where something failed.

  chaos.py build/release/bin/heartgen --kills 100 --seed 1
"""
import argparse
import filecmp
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

RECIPE_TAIL = """
[mesh]
meshes = ["myocardium"]
heart_edge_mm = 5
[fibers]
grid_mm = 4
depth_grid_mm = 2.5
demons_iterations = [4, 2, 1]
"""
DONE = (0, 3)  # what the certificate says of so coarse a mesh does not matter here
REFUSED = 2  # with a message


class Chaos:
    def __init__(self, program, folder, seed):
        self.program = os.path.abspath(program)
        self.folder = pathlib.Path(folder)
        self.random = random.Random(seed)
        self.table = {}
        self.notes = []

    # ---- running ----

    def run(self, *arguments, limits=(), kill_after=None):
        """Exit code (negative: the signal that ended it), standard error."""
        def set_limits():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            for kind, value in limits:
                resource.setrlimit(kind, (value, value))
        process = subprocess.Popen([self.program, *map(str, arguments)], cwd=self.folder, preexec_fn=set_limits,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            return process.wait(kill_after), process.communicate()[1]
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
            return process.wait(), process.communicate()[1]

    def must(self, *arguments):
        code, errors = self.run(*arguments)
        if code not in DONE:
            sys.exit(f"heartgen {' '.join(map(str, arguments))}: exit {code}\n{errors}")

    def build(self, out, *options, recipe="new.toml", **how):
        return self.run("build", "ph/" + recipe, "--output", out, "--force", "--quiet", *options, **how)

    # ---- judging ----

    def count(self, kind, problem):
        row = self.table.setdefault(kind, [0, 0, 0])
        row[0] += 1
        row[2 if problem else 1] += 1
        if problem:
            self.notes.append(f"{kind}: {problem}")
        print(".F"[bool(problem)], end="", flush=True)

    def content_id(self, out):
        if self.run("verify", out)[0] != 0:
            return "not whole"
        return json.loads((self.folder / out / "manifest.json").read_text())["content_id"]

    def problem_with(self, out, code, errors, may_be_killed):
        """What is wrong after a build that was disturbed, and after the next one; empty where nothing is."""
        if code not in (*DONE, REFUSED) and not (may_be_killed and code == -signal.SIGKILL):
            return f"ended by {code}: {errors.strip()[-200:]}"
        if code == REFUSED and len(errors.strip().splitlines()) != 1:
            return f"not one line: {errors}"
        found = self.content_id(out)
        if found not in (self.old, self.new) or (code in DONE and found != self.new):
            return f"exit {code}, the bundle is {found}"
        return ""

    def problem_after(self, out):
        code, errors = self.build(out)
        if code not in DONE or self.content_id(out) != self.new:
            return f"the next build ended with {code}: {errors.strip()[-200:]}"
        place = (self.folder / out).parent
        left = sorted(p.name for p in place.iterdir() if p.name not in (pathlib.Path(out).name, pathlib.Path(out).name + ".cache"))
        return f"left beside the bundle: {left}" if left else ""

    # ---- what is tried ----

    def prepare(self):
        self.must("phantom", "ph", "--size", "64,64,48", "--spacing", "5.4,5.4,6.3")
        recipe = (self.folder / "ph/recipe.toml").read_text()
        (self.folder / "ph/old.toml").write_text(recipe + RECIPE_TAIL)
        (self.folder / "ph/new.toml").write_text(recipe.replace('"1.0.0"', '"2.0.0"') + RECIPE_TAIL)
        self.must("build", "ph/old.toml", "--output", "old", "--quiet", "--no-cache")
        start = time.monotonic()
        self.must("build", "ph/new.toml", "--output", "new", "--quiet")
        self.cold_s = time.monotonic() - start
        start = time.monotonic()
        self.must("build", "ph/new.toml", "--output", "new", "--quiet", "--force")
        self.warm_s = time.monotonic() - start
        self.old, self.new = self.content_id("old"), self.content_id("new")
        print(f"a build takes {self.cold_s:.1f} s, {self.warm_s:.1f} s from the cache")

    def place(self, where, warm):
        """An older bundle in a fresh folder, and the cache where it is to be warm."""
        shutil.rmtree(self.folder / where, ignore_errors=True)
        (self.folder / where).mkdir()
        self.fill(where, warm)
        return where + "/W"

    def fill(self, where, warm):
        shutil.copytree(self.folder / "old", self.folder / where / "W")
        if warm:
            shutil.copytree(self.folder / "new.cache", self.folder / where / "W.cache")

    def kill_builds(self, times):
        for _ in range(times):
            warm = self.random.random() < 0.75
            out = self.place("k", warm)
            last = 1.05 * (self.warm_s if warm else self.cold_s)
            # Half of them at the end, where files are written and folders change places.
            after = last * (self.random.uniform(0.7, 1) if self.random.random() < 0.5 else self.random.random())
            code, errors = self.build(out, kill_after=after)
            problem = self.problem_with(out, code, errors, True) or self.problem_after(out)
            self.count("build, SIGKILL", problem and f"{'warm' if warm else 'cold'} cache, after {after:.2f} s: {problem}")

    def limit_builds(self, times):
        def disturbed(kind, limit, options):
            out = self.place("l", True)
            code, errors = self.build(out, *options, limits=[limit])
            self.count(kind, self.problem_with(out, code, errors, False) or self.problem_after(out))
        for _ in range(times):
            disturbed("build, ulimit -f", (resource.RLIMIT_FSIZE, self.random.randrange(1 << 10, 1 << 21)), ())
        for _ in range(times):
            disturbed("build, ulimit -v", (resource.RLIMIT_AS, self.random.randrange(300 << 20, 2 << 30)), ["--no-cache"])

    def mount(self, *options, where):
        return subprocess.run(["mount", *options, str(self.folder / where)], stderr=subprocess.DEVNULL).returncode == 0

    def full_disks(self, times):
        for _ in range(times):
            self.place("t", False)
            shutil.rmtree(self.folder / "t/W")
            if not self.mount("-t", "tmpfs", "-o", "size=1g", "tmpfs", where="t"):
                return self.notes.append("full and read-only disks: not tried, for want of the right to mount")
            try:
                self.fill("t", False)
                used = sum(f.stat().st_blocks * 512 for f in (self.folder / "t").rglob("*"))
                room = used + self.random.randrange(0, used)
                self.mount("-o", f"remount,size={room}", where="t")
                code, errors = self.build("t/W", "--no-cache" if self.random.random() < 0.5 else "--quiet")
                problem = self.problem_with("t/W", code, errors, False)
                self.mount("-o", "remount,size=1g", where="t")
                self.count("build, full disk", problem or self.problem_after("t/W"))
            finally:
                subprocess.run(["umount", str(self.folder / "t")], check=True)

    def read_only(self, times):
        for _ in range(times):
            self.place("t", False)
            shutil.rmtree(self.folder / "t/W")
            if not self.mount("-t", "tmpfs", "tmpfs", where="t"):
                return
            try:
                self.fill("t", False)
                self.mount("-o", "remount,ro", where="t")
                code, errors = self.build("t/W")
                problem = self.problem_with("t/W", code, errors, False)
                if code != REFUSED and not problem:
                    problem = f"exit {code} where nothing can be written"
                self.mount("-o", "remount,rw", where="t")
                self.count("build, read-only", problem or self.problem_after("t/W"))
            finally:
                subprocess.run(["umount", str(self.folder / "t")], check=True)

    def kill_filters(self, times):
        for ending in ("nii.gz", "nrrd", "mhd"):
            results = []
            for filter_name in ("heat", "perona_malik"):
                (self.folder / filter_name).mkdir(exist_ok=True)
                start = time.monotonic()
                self.must("filter", filter_name, "ph/ct.nii.gz", f"{filter_name}/o.{ending}", "--iterations", 1)
                results.append(self.folder / filter_name)
            last = time.monotonic() - start
            names = [f"o.{ending}"] + (["o.zraw"] if ending == "mhd" else [])
            for _ in range(times):
                shutil.rmtree(self.folder / "f", ignore_errors=True)
                shutil.copytree(results[0], self.folder / "f")
                self.run("filter", "perona_malik", "ph/ct.nii.gz", f"f/o.{ending}", "--iterations", 1,
                         kill_after=last * self.random.uniform(0.5, 1.05))
                whole = any(all(filecmp.cmp(self.folder / "f" / n, r / n, False) for n in names) for r in results)
                code, errors = self.run("filter", "perona_malik", "ph/ct.nii.gz", f"f/o.{ending}", "--iterations", 1)
                left = sorted(p.name for p in (self.folder / "f").iterdir()) != sorted(names)
                self.count(f"filter to .{ending}, SIGKILL", "mixed" if not whole else errors if code else "left over" if left else "")
            for r in results:
                shutil.rmtree(r)

    def print_table(self):
        print(f"\n\n{'':<32} {'tried':>6} {'held':>6} {'failed':>6}")
        for kind, row in self.table.items():
            print(f"{kind:<32} {row[0]:>6} {row[1]:>6} {row[2]:>6}")
        for note in self.notes:
            print(note)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=100, help="of builds; the other rows have a tenth of it, or more")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    others = max(1, options.kills // 10)
    with tempfile.TemporaryDirectory(prefix="heartgen_chaos_") as folder:
        chaos = Chaos(options.program, folder, options.seed)
        chaos.prepare()
        chaos.kill_builds(options.kills)
        chaos.limit_builds(others)
        chaos.full_disks(others)
        chaos.read_only(max(1, others // 5))
        chaos.kill_filters(others)
        chaos.print_table()
    return 1 if any(row[2] for row in chaos.table.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
