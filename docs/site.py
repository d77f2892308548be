"""Builds the site: collects the pages of docs/SUMMARY.md, runs mdBook, and checks links and search.

    python3 docs/site.py [GELENK]        GELENK: path of the program gelenk [default: target/debug/gelenk]

Pages keep the layout of the repository, so that their relative links stay valid. mdbook must be in PATH (tests/python/site.txt).
"""

import concurrent.futures
import html.parser
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
SRC, BOOK = ROOT / "target/site/src", ROOT / "target/site/book"
REPOSITORY = re.search(r'^repository = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.M)[1]
FENCE = re.compile(r"^( *```.*?^ *```)", re.S | re.M)
LINK = re.compile(r'(\]\(|^\[[^\]]+\]: |src="|srcset=")([^)"\s]+)', re.M)
WORDS = ["SINDy", "STLS", "LASSO", "TVDiff", "LQR", "LTV-MPC"]


def pages():
    """Returns the titles of all pages by their paths in the repository."""
    summary = (ROOT / "docs/SUMMARY.md").read_text()
    found = re.findall(r"\[(.*?)\]\((.*?)\)", summary)
    return {os.path.normpath(f"docs/{path}"): title for title, path in found}


def place(path):
    """Returns the path of a page in the site. A README becomes the index of its folder."""
    return re.sub(r"README\.md$", "index.md", path)


def linked(page, target, known):
    """Returns the address in the site for a link of a page; `None` for items of Rust without a page."""
    if "://" in target or target.startswith("#"):
        return target
    path, _, anchor = target.partition("#")
    anchor = anchor and f"#{anchor}"
    if "::" in path:
        stem = path.split("::")[-1]
        path = next((known_page for known_page in known if pathlib.Path(known_page).stem == stem), None)
        if path is None:
            return None
    else:
        path = os.path.normpath(os.path.join(os.path.dirname(page), path))
    if path in known:
        return os.path.relpath(place(path), os.path.dirname(page) or ".") + anchor
    if path.endswith((".png", ".svg")):
        (SRC / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, SRC / path)
        return target
    return f"{REPOSITORY}/{'tree' if (ROOT / path).is_dir() else 'blob'}/main/{path}{anchor}"


def prose(page, text, known):
    """Returns text outside of code blocks with the links of the site."""

    def link(match):
        address = linked(page, match[2], known)
        return match[1] + address if address else match[0]

    text = LINK.sub(link, text)
    # Links to items of Rust without a page become code.
    text = re.sub(r"\[([^\[\]]+)\]\([\w:]*::[^)]*\)", r"\1", text)
    return re.sub(r"\[(`[^`\]]+`)\](?![(\[:])", r"\1", text)


def page_text(page, title, known):
    text = (ROOT / page).read_text()
    parts = FENCE.split(text)
    # rustdoc compiles blocks without a language as Rust.
    parts[1::2] = [re.sub(r"^( *)```\n", r"\1```rust\n", part, count=1) for part in parts[1::2]]
    # Each page has one heading of the first level. Guides for rustdoc have several, which become headings of the second level.
    own = re.match(r"# .*\n", parts[0])
    parts[0] = parts[0][own.end() :] if own else parts[0]
    if any(re.search(r"^# ", part, re.M) for part in parts[::2]):
        parts[::2] = [re.sub(r"^(#+ )", r"#\1", part, flags=re.M) for part in parts[::2]]
    parts[0] = (own[0] if own else f"# {title}\n\n") + parts[0]
    parts[::2] = [prose(page, part, known) for part in parts[::2]]
    return "".join(parts)


def help_texts(program):
    ask = lambda *words: subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout
    whole = ask("--help")
    commands = re.findall(r"^  (\w+)  ", whole.split("Commands:")[1].split("Options:")[0], re.M)
    texts = [("gelenk", whole)] + [(f"gelenk {name}", ask(name, "--help")) for name in commands if name != "help"]
    return "".join(f"## {name}\n\n```text\n{text}```\n\n" for name, text in texts)


def gallery(program):
    """Makes the page of each robot, and returns the table of all robots."""
    names = sorted(path.stem for path in (ROOT / "models").glob("*.toml"))
    run = lambda *words: subprocess.run([program, *words], cwd=ROOT, capture_output=True, text=True)

    def page(name):
        description = f"models/{name}.toml"
        report = run("report", description, "--output", SRC / f"docs/gallery/{name}")
        if report.returncode:
            sys.exit(f"{description}: {report.stderr or report.stdout}")
        model = json.loads(run("inspect", description, "--format", "json").stdout)
        data = json.loads((SRC / f"docs/gallery/{name}/report.json").read_text())
        closed = run("inspect", "equations", description)
        if closed.returncode == 0:
            (SRC / f"docs/gallery/{name}/equations.tex").write_text(closed.stdout)
        equations = f"[LaTeX](gallery/{name}/equations.tex)" if closed.returncode == 0 else ""
        words = re.split(r"(?<=[a-z0-9)][a-z0-9)]\.) ", " ".join(model["description"]).strip())[0]
        return f"| [`{name}`](gallery/{name}/index.html) | {words} | {data['facts']['coordinates']} | {equations} |"

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        rows = list(pool.map(page, names))
    return "\n".join(["| robot | description | coordinates | closed form |", "|---|---|---|---|", *rows]) + "\n"


def collect(program):
    shutil.rmtree(SRC, ignore_errors=True)
    known = pages()
    for page, title in known.items():
        target = SRC / place(page)
        target.parent.mkdir(parents=True, exist_ok=True)
        text = page_text(page, title, known)
        for mark, made in GENERATED.items():
            if mark in text:
                text = text.replace(mark, made(program))
        target.write_text(text)
    shutil.copytree(ROOT / "docs/tutorial", SRC / "docs/tutorial")
    summary = (ROOT / "docs/SUMMARY.md").read_text()
    (SRC / "SUMMARY.md").write_text(LINK.sub(lambda m: m[1] + place(os.path.normpath(f"docs/{m[2]}")), summary))


GENERATED = {"<!-- help -->": help_texts, "<!-- robots -->": gallery}


class Anchors(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.ids, self.links = set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.ids.update(filter(None, [attributes.get("id"), attributes.get("name")]))
        self.links += [attributes[key] for key in ("href", "src") if attributes.get(key)]


def broken():
    """Returns the broken links of the site."""
    parsed = {path: Anchors(path.read_text()) for path in BOOK.rglob("*.html") if path.name not in ("print.html", "toc.html", "404.html")}
    for path, page in parsed.items():
        for link in page.links:
            address = urllib.parse.urlsplit(link)
            if address.scheme or address.netloc:
                continue
            target = (path.parent / urllib.parse.unquote(address.path)).resolve() if address.path else path
            has_anchor = target not in parsed or not address.fragment or urllib.parse.unquote(address.fragment) in parsed[target].ids
            if not target.exists() or not has_anchor:
                yield f"{path.relative_to(BOOK)}: {link}"


def main():
    collect(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/debug/gelenk")
    subprocess.run(["mdbook", "build", ROOT], check=True)
    problems = list(broken())
    index = "".join(path.read_text() for path in BOOK.glob("searchindex*.js")).lower()
    problems += [f"not found by the search: {word}" for word in WORDS if word.lower() not in index]
    print("\n".join(problems) or f"{len(pages())} pages in {BOOK}")
    sys.exit(bool(problems))


main()
