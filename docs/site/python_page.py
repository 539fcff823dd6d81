# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of the module for Python: signatures and docstrings, read without importing it."""
import ast
import inspect


def public_names(init):
    return next(ast.literal_eval(node.value) for node in init.body
                if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")


def doc_of(node):
    """A docstring as Markdown: its examples as code."""
    text = inspect.cleandoc(ast.get_docstring(node) or "")
    lines, in_example = [], False
    for line in text.splitlines():
        starts = line.startswith(">>>")
        if starts and not in_example:
            lines += ["``` pycon"]
        if in_example and not line:
            lines += ["```"]
            in_example = False
        in_example = in_example or starts
        line = line.replace("  # doctest: +SKIP", "").rstrip()
        lines.append(line if in_example else line.replace("``", "`"))
    return "\n".join(lines + (["```"] if in_example else []))


def signature(node):
    """On one line where it fits, else an argument a line."""
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    arguments = split_arguments(node)
    line = f"{node.name}({', '.join(arguments)}){returns}"
    return line if len(line) < 100 else f"{node.name}(\n    " + ",\n    ".join(arguments) + f",\n){returns}"


def split_arguments(node):
    """Arguments one by one, with annotations and defaults."""
    args = node.args
    positional = args.posonlyargs + args.args
    defaults = [None] * (len(positional) - len(args.defaults)) + args.defaults
    pairs = list(zip(positional, defaults))
    texts = [spelled(argument, default) for argument, default in pairs]
    if args.vararg:
        texts.append("*" + ast.unparse(args.vararg))
    elif args.kwonlyargs:
        texts.append("*")
    texts += [spelled(argument, default) for argument, default in zip(args.kwonlyargs, args.kw_defaults)]
    if args.kwarg:
        texts.append("**" + ast.unparse(args.kwarg))
    return [text for text in texts if text not in ("self", "cls")]


def spelled(argument, default):
    if default is None:
        return ast.unparse(argument)
    return ast.unparse(argument) + (" = " if argument.annotation else "=") + ast.unparse(default)


def is_property(node):
    return any("property" in ast.unparse(decorator) for decorator in node.decorator_list)


def class_parts(node):
    """Fields, then properties and methods."""
    lines = []
    for part in node.body:
        if isinstance(part, ast.AnnAssign):
            lines.append(f"- `{ast.unparse(part)}`")
    lines += [""] if lines else []
    for part in node.body:
        if not isinstance(part, ast.FunctionDef) or part.name.startswith("_"):
            continue
        if is_property(part):
            returns = f": {ast.unparse(part.returns)}" if part.returns else ""
            lines += [f"### {part.name}", "", "``` python", f"{part.name}{returns}", "```", "", doc_of(part), ""]
        else:
            lines += [f"### {part.name}()", "", "``` python", signature(part), "```", "", doc_of(part), ""]
    return lines


def entry(node):
    if isinstance(node, ast.FunctionDef):
        return [f"## {node.name}()", "", "``` python", signature(node), "```", "", doc_of(node), ""]
    bases = f"({', '.join(map(ast.unparse, node.bases))})" if node.bases else ""
    lines = [f"## {node.name}", "", "``` python", f"class {node.name}{bases}", "```", "", doc_of(node), ""]
    return lines + class_parts(node)


def write_python_page(package, page):
    parsed = {name: ast.parse((package / name).read_text(encoding="utf-8"))
              for name in ("__init__.py", "bundles.py", "meshes.py", "images.py", "_native.pyi")}
    wanted = set(public_names(parsed["__init__.py"]))
    lines = ["# Python API", "", doc_of(parsed["__init__.py"]), "", "[Python](python.md) shows them at work.", ""]
    for module in ("bundles.py", "meshes.py", "images.py", "_native.pyi"):
        for node in parsed[module].body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and node.name in wanted:
                wanted.discard(node.name)
                lines += entry(node)
    missing = wanted - {"__version__"}
    if missing:
        raise SystemExit(f"python_page: no source of {', '.join(sorted(missing))}")
    page.write_text("\n".join(lines), encoding="utf-8")
