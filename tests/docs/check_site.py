#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the site of the documentation, as docs/run builds it: every link within it leads to a page
and an anchor that exist, no page loads anything from another host, no directive of a code block is
shown, and, in Chromium if it is installed, the formulas are typeset and nothing fails to load.

    check_site.py SITE         prints the faults and exits with 1 if there is one
    check_site.py --self-test  checks that faults are found
"""

import functools
import html.parser
import http.server
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import urllib.parse

# Attributes that load what they name; of links those without a rel of NAMED.
LOADED = {("script", "src"), ("img", "src"), ("iframe", "src"), ("video", "src"), ("video", "poster"),
          ("audio", "src"), ("source", "src"), ("embed", "src"), ("object", "data"), ("link", "href")}
NAMED = ("canonical", "next", "prev")
# Directives as text: a code block is preceded by a comment with them, which must not be in the page.
DIRECTIVE = re.compile(r"<!-- silt:|&lt;!-- silt:")


class Page(html.parser.HTMLParser):
    """Anchors, links and loaded files of a page."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loaded, self.formulas = set(), [], [], 0
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[name] for name in ("id", "name") if values.get(name)}
        if "arithmatex" in (values.get("class") or "").split():
            self.formulas += 1
        for name, value in attributes:
            if value is None:
                continue
            if (tag, name) in LOADED and values.get("rel") not in NAMED:
                self.loaded.append(value)
            elif (tag, name) in (("a", "href"), ("area", "href"), ("link", "href")):
                self.links.append(value)


@functools.lru_cache(maxsize=None)
def page_of(path):
    return Page(path.read_text(encoding="utf-8"))


def is_elsewhere(link):
    return re.match(r"(?:[a-z]+:)?//|mailto:", link) is not None


def fault_of_link(site, page, link):
    """Why a link of this page is broken; empty if it is not."""
    if is_elsewhere(link) or re.match(r"(?:javascript|data):", link):
        return ""
    address, _, anchor = link.partition("#")
    address = urllib.parse.unquote(address.partition("?")[0])
    # The error page is served at any address and has absolute links.
    target = page.parent / address if address else page
    if address.startswith("/"):
        target = site / address.lstrip("/")
    if target.is_dir():
        target /= "index.html"
    if not target.is_file():
        return "no such file"
    anchor = urllib.parse.unquote(anchor)
    if anchor and target.suffix == ".html" and anchor not in page_of(target).anchors:
        return "no such anchor"
    return ""


def faults_of_page(site, path):
    text = path.read_text(encoding="utf-8")
    page = page_of(path)
    name = path.relative_to(site).as_posix()
    faults = [f"{name}: loads {link} from another host" for link in page.loaded if is_elsewhere(link)]
    for link in dict.fromkeys(page.links + page.loaded):
        if fault := fault_of_link(site, path, link):
            faults.append(f"{name}: the link to {link} is broken: {fault}")
    if not name.startswith(("source/", "api/")) and DIRECTIVE.search(text):
        faults.append(f"{name}: shows a directive of a code block")
    return faults


def faults_of_tree(site, path):
    """Faults of the links in the navigation tree of Doxygen, which are in scripts."""
    text = path.read_text(encoding="utf-8")
    links = dict.fromkeys(re.findall(r'\[\s*"[^"]*",\s*"(\w+\.html(?:#\w+)?)"', text))
    return [f"{path.relative_to(site)}: the link to {link} is broken: {fault}"
            for link in links if (fault := fault_of_link(site, path, link))]


def faults_of_style(site, path):
    faults = []
    for link in re.findall(r"(?:url\(|@import\s)\s*['\"]?([^'\")]+)", path.read_text(encoding="utf-8")):
        if is_elsewhere(link):
            faults.append(f"{path.relative_to(site)}: loads {link} from another host")
        elif fault := fault_of_link(site, path, link):
            faults.append(f"{path.relative_to(site)}: {link}: {fault}")
    return faults


def faults_in_browser(site, chromium, pages):
    """Opens pages in Chromium, without a network: what fails to load, and formulas that are not typeset."""
    faults = []

    class Handler(http.server.SimpleHTTPRequestHandler):
        def __init__(self, *arguments):
            super().__init__(*arguments, directory=site)

        def log_message(self, *_):
            pass

        def send_error(self, code, *_):
            faults.append(f"{self.headers.get('Referer', '')}: {self.path} fails to load: {code}")
            super().send_error(code)

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        for path in pages:
            name = path.relative_to(site).as_posix()
            with tempfile.TemporaryDirectory() as profile:
                shown = subprocess.run(
                    [chromium, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}",
                     "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
                     "--virtual-time-budget=30000", "--dump-dom",
                     f"http://127.0.0.1:{server.server_port}/{name}"],
                    capture_output=True, text=True, timeout=300)
            formulas = page_of(path).formulas
            # MathJax makes one frame of each formula.
            typeset = len(re.findall(r'id="MathJax-Element-\d+-Frame"', shown.stdout))
            errors = len(re.findall(r'class="[^"]*merror', shown.stdout))
            if typeset != formulas or errors:
                faults.append(f"{name}: {typeset} of {formulas} formulas are typeset, {errors} with errors")
    finally:
        server.shutdown()
    return faults


def faults_of(site):
    pages = sorted(site.rglob("*.html"))
    if not pages:
        return [f"{site}: no page; build the site with docs/run"]
    faults = [fault for path in pages for fault in faults_of_page(site, path)]
    for path in sorted(site.glob("api/*.js")):
        faults += faults_of_tree(site, path)
    for path in sorted(site.rglob("*.css")):
        faults += faults_of_style(site, path)
    with_formulas = [path for path in pages if page_of(path).formulas]
    if chromium := shutil.which("chromium"):
        faults += faults_in_browser(site, chromium, with_formulas)
    else:
        print("Formulas in the browser are skipped: chromium is missing")
    print(f"{len(pages)} pages, {len(with_formulas)} of them with formulas, {len(faults)} faults")
    return faults


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        site = pathlib.Path(folder).resolve()
        (site / "api").mkdir()
        (site / "b.html").write_text('<h2 id="there">B</h2><a name="old"></a>')
        sound = ('<a href="b.html#there">b</a> <a href="b.html#old">c</a> <a href="https://a.b/c">d</a>'
                 '<a href="#e" id="e">e</a>')
        for text, count in (
            (sound, 0),
            (sound + '<a href="none.html">', 1),
            (sound + '<a href="b.html#none">', 1),
            (sound + '<img src="none.png">', 1),
            (sound + '<script src="https://a.b/c.js"></script>', 1),
            (sound + '<link rel="stylesheet" href="//a.b/c.css">', 1),
            (sound + "<!-- silt: wrap -->", 1),
            (sound + '<a href="api/">', 1),
        ):
            page_of.cache_clear()
            (site / "a.html").write_text(text)
            assert len(faults_of_page(site, site / "a.html")) == count, text
        (site / "api" / "tree.js").write_text('var a = [["A", "none.html", null], ["T", "tree.html#b"]];')
        (site / "api" / "tree.html").write_text('<p id="b">')
        assert len(faults_of_tree(site, site / "api" / "tree.js")) == 1
        (site / "a.css").write_text("@import 'b.html'; a { b: url(https://a.b/c.woff) } c { d: url(none.png) }")
        assert len(faults_of_style(site, site / "a.css")) == 2
        assert faults_of(site / "api" / "empty")


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return
    if len(arguments) != 1:
        sys.exit(__doc__)
    faults = faults_of(pathlib.Path(arguments[0]).resolve())
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
