#!/usr/bin/python3
"""Paces the right atrium of exported meshes in FreeFEM and looks whether the wave comes into the ventricles.

usage: pacing.py EXPORTS stops|passes

EXPORTS/medit holds meshes as heartgen wrote them; those with a right atrium and ventricles are paced. Muscle that conducts
is what is no annulus. The potential obeys u - 100 mm2 div grad u = 0 there, u = 1 at one node of the atrium: it falls with
the distance, and is 0 where nothing conducts it to. "stops": it must be 0 in all of the ventricles, and reach the whole
atrium; "passes": it must reach the ventricles too. Exit code 0: so it is; 1: not so; 77: FreeFEM is not installed.
"""
import glob
import json
import os
import re
import shutil
import subprocess
import sys

ATRIA, VENTRICLES = ("la_wall", "ra_wall"), ("lv_myocardium", "rv_myocardium", "papillary")
DECK = """
mesh3 heart = readmesh3("{mesh}");
fespace P1h(heart, P1);
macro grad(u) [dx(u), dy(u), dz(u)] //
varf wave(u, w) = int3d(heart, {muscle}, qfV = qfV1lump)(u*w) + int3d(heart, {muscle})(100*{mm}*{mm}*(grad(u)'*grad(w)));
varf atrium(unused, w) = int3d(heart, {atrium}, qfV = qfV1lump)(w);
varf ventricles(unused, w) = int3d(heart, {ventricles}, qfV = qfV1lump)(w);
varf muscle(unused, w) = int3d(heart, {muscle}, qfV = qfV1lump)(w);
P1h ofatrium, ofventricles, ofmuscle, u;
ofatrium[] = atrium(0, P1h);
ofventricles[] = ventricles(0, P1h);
ofmuscle[] = muscle(0, P1h);
int site = 0;
for (int i = 0; i < P1h.ndof; i++) if (ofatrium[][i] > ofatrium[][site]) site = i;
matrix A = wave(P1h, P1h);
real[int] d = A.diag, b(P1h.ndof);
real large = 1e10 * d.max;
b = 0;
b[site] = large;
d[site] += large;
for (int i = 0; i < P1h.ndof; i++) if (ofmuscle[][i] == 0) d[i] = large;
A.diag = d;
set(A, solver = CG, eps = 1e-20);
u[] = A^-1 * b;
real low = 1, high = 0;
int reached = 0, all = 0;
for (int i = 0; i < P1h.ndof; i++) {{
  if (ofventricles[][i] > 0) high = max(high, abs(u[][i]));
  if (ofatrium[][i] > 0) {{ all++; if (u[][i] > 0) reached++; }}
}}
cout << "PACED " << high << " " << reached << " " << all << endl;
"""


def pace(folder, name, markers):
    tags = {region: markers[region][0] for region in ATRIA + VENTRICLES if region in markers}
    listed = lambda regions: ", ".join(str(tags[region]) for region in regions if region in tags)
    deck = os.path.join(folder, name + "_pacing.edp")
    with open(deck, "w", encoding="ascii") as stream:
        stream.write(DECK.format(mesh=name + ".mesh", mm=1, muscle=listed(ATRIA + VENTRICLES), atrium=tags["ra_wall"],
                                 ventricles=listed(VENTRICLES)))
    result = subprocess.run(["FreeFem++", "-nw", "-v", "0", os.path.basename(deck)], cwd=folder, capture_output=True, text=True)
    found = re.search(r"PACED (\S+) (\S+) (\S+)", result.stdout)
    if result.returncode != 0 or not found:
        sys.exit(f"FAILED {name}: FreeFEM ends with {result.returncode}\n{(result.stdout + result.stderr)[-1500:]}")
    return float(found.group(1)), int(found.group(2)), int(found.group(3))


def main(exports, wanted):
    if not shutil.which("FreeFem++"):
        print("FreeFem++ is not installed")
        return 77
    paced = 0
    for path in sorted(glob.glob(os.path.join(exports, "medit", "*.mesh"))):
        folder, name = os.path.dirname(path), os.path.basename(path)[: -len(".mesh")]
        with open(os.path.join(folder, name + "_markers.json"), encoding="utf-8") as stream:
            markers = json.load(stream)
        if "ra_wall" not in markers or not any(region in markers for region in VENTRICLES):
            continue
        high, reached, nodes = pace(folder, name, markers)
        paced += 1
        print(f"{name}: {reached} of {nodes} nodes of the right atrium are reached, the ventricles have up to {high:.3g}")
        if 10 * reached < 9 * nodes or (high == 0) != (wanted == "stops"):
            print(f"FAILED {name}: the wave {'passes' if high else 'stops'}")
            return 1
    print(f"{paced} meshes paced")
    return 0 if paced else 1


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[2] not in ("stops", "passes"):
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
