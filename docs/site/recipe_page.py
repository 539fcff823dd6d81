# SPDX-License-Identifier: GPL-3.0-or-later
"""The recipe reference: keys, defaults and meanings as the program writes them, introductions from model/recipe.hpp."""
import re
import subprocess

HEADER = re.compile(r"^(\[\[?)([\w.]+)\]\]?$")
KEY = re.compile(r"^(\w+) = (.*?)(?:  # (.*))?$")
STRUCT = re.compile(r"((?:^/// .*\n)+)struct (\w+) \{", re.MULTILINE)
MEMBER = re.compile(r"^  (?:std::vector<)?(\w+)>? (\w+)\W", re.MULTILINE)
TOP = {"name": "of the model, for its citation", "version": "of the model", "license": "of the bundle",
       "author": "for the citation; `;` between several", "attribution": "whose scan and atlas the model is made from",
       "date_published": "YYYY-MM-DD, the only date in a bundle",
       "synthetic_image": "the CT is a phantom: the report says so"}
FREE = {"labels.regions": 'A region\'s name and what means it: `lv_blood = [500, "left ventricle"]`, values or names. They go '
                          "before the preset.",
        "landmarks": "`lv_apex_mm = [x, y, z]` in LPS mm. What is not given is searched for in the CT.",
        "landmarks.seeds_mm": "A point in each: `lv_blood = [x, y, z]` and so on. Valves are sections "
                              "`[landmarks.valves.mitral]` with `center_mm`, `normal` and `radius_mm`. A file for "
                              "`input.landmarks`, as `heartgen landmarks` writes it, holds all of these."}


def introductions(header):
    """{section: what the struct of its settings says of itself}."""
    says = {name: re.sub(r"^/// ", "", text, flags=re.M).replace("\n", " ").strip() for text, name in STRUCT.findall(header)}
    recipe = header[header.index("struct Recipe {"):]
    found = {section: says[kind] for kind, section in MEMBER.findall(recipe) if kind in says}
    found["fibers.rule"] = says["RuleSettings"]
    return {section: cell(text) for section, text in found.items()} | FREE


def cell(text):
    return re.sub(r"([|<*_\[])", r"\\\1", text)


def write_recipe_page(default_recipe, header, page):
    text = subprocess.run([default_recipe], check=True, capture_output=True, text=True).stdout
    introduction = introductions(header.read_text(encoding="utf-8"))
    lines = ["# Recipe reference", "",
             "Every key of a recipe with its default. A recipe is a TOML file; what it does not say has the default. Lengths are "
             "mm, grey values Hounsfield units. [Inputs](inputs.md) shows recipes at work; ranges and sources of the numbers "
             "about patients stand in [numbers](numbers.md).", "",
             "The copy of the recipe in every bundle, `recipe.toml`, is this list with the values that were used.", ""]
    seen, in_table, skipped = set(), False, False
    for line in text.splitlines():
        if found := HEADER.match(line):
            bracket, section = found.groups()
            skipped = section in seen
            in_table = False
            if not skipped:
                seen.add(section)
                lines += ["", f"## {bracket}{section}{bracket.replace('[', ']')}", ""]
                lines += [introduction[section], ""] if section in introduction else []
        elif (found := KEY.match(line)) and not skipped:
            key, value, meaning = found.groups()
            if not in_table:
                lines += ["| key | default | meaning |", "|---|---|---|"]
                in_table = True
            lines.append(f"| `{key}` | `{value}` | {cell(meaning or TOP.get(key, ''))} |")
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")
