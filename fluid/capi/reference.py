#!/usr/bin/env python3
"""reference.py ROOT: writes docs/api.md from the headers that a host includes (public_headers.txt): a list of them, then the comment that each
begins with, and its declarations. With --check: exit 1 if the page differs from the headers."""
import pathlib
import re
import sys


def listed(root):
    """[(heading, [paths])] of public_headers.txt; a pattern gives the files that it matches."""
    groups = []
    for line in (root / "fluid/capi/public_headers.txt").read_text().split("\n\n", 1)[1].splitlines():
        if line.startswith("# "):
            groups.append((line[2:], []))
        elif line:
            found = sorted(str(p.relative_to(root)) for p in root.glob(line))
            if not found:
                sys.exit(f"{line} does not exist: correct the list in fluid/capi/public_headers.txt")
            groups[-1][1].extend(found)
    return groups


def public(name):
    """How a host includes it."""
    return "rivulet/" + name.removeprefix("fluid/capi/")


def comment(source, name):
    """The comment that a header begins with, and the rest."""
    if name.startswith("fluid/capi/"):
        head, body = source.split("*/", 1)
        return "\n".join(re.sub(r"^ ?\*? ?", "", line) for line in head.replace("/*", "", 1).splitlines()).strip(), body
    lines = source.splitlines()
    n = next(k for k, line in enumerate(lines) if not line.startswith("//"))
    return "\n".join(re.sub(r"^// ?", "", line) for line in lines[:n]), "\n".join(lines[n:])


def index(root):
    text = ("\n## Headers\n\nA host includes headers as below, and no others; what these include is installed with them. Of the kernel language and "
            "the shaders, each file is its own reference.\n")
    for heading, names in listed(root):
        text += f"\n{heading}:\n\n"
        for name in names:
            said = " ".join(re.split(r"\n\s*\n", comment((root / name).read_text(), name)[0])[0].split()).removeprefix("rivulet.h: ")
            sentence = re.split(r"(?<=[A-Za-z0-9)])(?<!et al)[.](?: |$)", said)[0]
            text += f"- `{public(name)}`: {sentence}\n"
    return text


def without_private(text):
    """Classes without their private members."""
    out, hidden, depth = [], None, 0
    for line in text.splitlines():
        if hidden is None and re.match(r"\s*private:$", line):
            hidden, depth = len(line) - len(line.lstrip()), 0
        if hidden is None:
            out.append(line)
        elif re.match(r"\s*};", line) and len(line) - len(line.lstrip()) < max(hidden, 1):
            hidden = None
            while out and not out[-1].strip():
                out.pop()
            out.append(line)
    return "\n".join(out)


def page(root):
    text = "# The API\n\nWritten by `fluid/capi/reference.py` from the headers that a host includes; how to use them is in [embedding.md](embedding.md).\n"
    text += index(root)
    for name in (name for _, names in listed(root) for name in names if not name.startswith("shaders/")):
        said, body = comment((root / name).read_text(), name)
        if name.startswith("fluid/capi/"):
            # rivulet.h itself includes the others and declares nothing.
            body = body.split('extern "C" {\n#endif', 1)[1].split("#ifdef __cplusplus", 1)[0] if 'extern "C"' in body else ""
        else:
            body = re.sub(r"^#.*\n", "", body, flags=re.M)
            body = re.sub(r"^namespace [\w:]+ \{\n|^\}  // namespace [\w:]+\n?", "", body, flags=re.M)
            body = without_private(body)
        said = re.sub(r"((?:^ {4}.*\n?)+)", lambda m: "\n" + m.group(1) + "\n", said, flags=re.M)
        body = re.sub(r"\n{3,}", "\n\n", body).strip()
        language = "c" if name.startswith("fluid/capi/") else "cpp"
        text += f"\n## {public(name)}\n\n{said.strip()}\n" + (f"\n```{language}\n{body}\n```\n" if body else "")
    return text


root = pathlib.Path(sys.argv[1])
written = page(root)
target = root / "docs/api.md"
if "--check" in sys.argv:
    if not target.exists() or target.read_text() != written:
        sys.exit("docs/api.md differs from the headers: run python3 fluid/capi/reference.py .")
else:
    target.write_text(written)
