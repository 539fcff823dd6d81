"""headers.py FOLDER COMPILER: every installed header compiles alone, and drags in nothing but the standard library."""
import pathlib
import re
import subprocess
import sys

folder, compiler = pathlib.Path(sys.argv[1]), sys.argv[2]
headers = sorted(folder.rglob("*.hpp"))
public = sorted((folder / "heartgen").glob("*.hpp"))
assert len(public) >= 12, public
problems = []
for header in headers:
    for include in re.findall(r"^#include (.*)$", header.read_text(), re.M):
        if not re.fullmatch(r'<[a-z_]+>|"heartgen/[a-z_0-9/]+\.hpp"', include):
            problems.append(f"{header} includes {include}")
for header in public:
    words = [compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I", str(folder)]
    done = subprocess.run([*words, "-include", str(header), "-x", "c++", "/dev/null"], capture_output=True, text=True)
    if done.returncode:
        problems.append(f"{header}:\n{done.stderr[:2000]}")
print("\n".join(problems) or f"{len(headers)} headers, {len(public)} of them public")
sys.exit(bool(problems))
