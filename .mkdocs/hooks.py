# SPDX-License-Identifier: MIT
"""Hooks of mkdocs: pages of the site that are not files of docs/, and links to them.

- index.md is start.md beside this file, with parts of README.
- references.md is made from docs/references.bib; [Key] links to it.
- Links to other files of the repository lead to source/PATH.md, a page with the highlighted file, or,
  for headers, to the source page of the API reference.
- `code` that is the name of something public in the library links to the API reference.
- a_b, x^{2}, l0 outside code and formulas are set as subscript and superscript.

The environment variable SILT_SITE_BUILD names the folder in which docs/run has made api/, with the
tag file api.tag, live/ and assets/.
"""

import html
import json
import os
import pathlib
import posixpath
import re
import xml.etree.ElementTree

import pybtex.database
import pybtex.plugin
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File
from mkdocs.utils import get_relative_url

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
MADE = pathlib.Path(os.environ.get("SILT_SITE_BUILD", REPOSITORY / "build" / "site"))

LANGUAGES = {".cpp": "cpp", ".hpp": "cpp", ".py": "python", ".sh": "bash", ".mjs": "js", ".js": "js",
             ".html": "html", ".css": "css", ".cmake": "cmake", ".txt": "cmake", ".json": "json"}

# The live page, or a page in its place.
LIVE_PAGE = "live/index.html" if (MADE / "live" / "index.html").exists() else "live/index.md"
NO_LIVE_PAGE = """# Live page

It is not part of this copy of the site, because a package that it needs was not installed, or npm could not
download the library that draws its curve. `docs/live/run` says which, and serves the page once it is built.
"""

# Pages that are always there; those in source/ depend on links.
GENERATED = {"index.md", "references.md"} | ({LIVE_PAGE} if LIVE_PAGE.endswith(".md") else set())

CODE = re.compile(r"(^[ ]*```.*?^[ ]*```[ ]*$|`[^`\n]+`|^\$\$.*?\$\$)", re.M | re.S)
LINK = re.compile(r"(\]\()([^)\s]+)(\))")


def text_of(path):
    return path.read_text(encoding="utf-8")


def outside_code(text, function):
    """The Markdown text with the function applied to what is not code."""
    return "".join(part if i % 2 else function(part) for i, part in enumerate(CODE.split(text)))


# --- navigation ----------------------------------------------------------------------------------


def pages_of_folder(docs, folder):
    """Its README.md or index.md first, the others in the order of its links to them."""
    pages = sorted(path.relative_to(docs).as_posix() for path in (docs / folder).glob("*.md"))
    first = next((page for page in pages if page.endswith(("/README.md", "/index.md"))), None)
    text = text_of(docs / first) if first else ""
    order = [first, *(posixpath.join(folder, link) for _, link, _ in LINK.findall(text))]
    return sorted(pages, key=lambda page: order.index(page) if page in order else len(order))


TABS = []  # titles and addresses of the top navigation


def on_config(config):
    docs = pathlib.Path(config["docs_dir"])
    listed = set()

    def resolve(entries):
        result = []
        for entry in entries:
            if isinstance(entry, dict):
                (title, value), = entry.items()
                several = isinstance(value, list) or value.endswith("/")
                value = resolve(value if isinstance(value, list) else [value])
                if value:
                    result.append({title: value if several else value[0]})
            elif entry.startswith("/") or entry in GENERATED or (docs / entry).is_file():
                listed.add(entry)
                result.append(entry)
            elif entry.endswith("/"):
                result += resolve(pages_of_folder(docs, entry))
        return result

    config["nav"] = resolve(config["nav"])
    pages = {path.relative_to(docs).as_posix() for path in docs.rglob("*.md")}
    if rest := sorted(pages - listed):
        raise PluginError(f"not listed in .mkdocs/mkdocs.yml: {', '.join(rest)}")
    return config


def on_nav(nav, config, files):
    def mend(items):
        for item in items:
            if item.is_link:
                item.url = item.url.lstrip("/")
            mend(item.children or [])

    def first(item):
        return first(item.children[0]) if item.children else item.url if item.is_link else item.file.url

    mend(nav.items)
    TABS[:] = [(item.title, first(item)) for item in nav.items]
    return nav


# --- pages and files -----------------------------------------------------------------------------


def file_of(path, folder, config):
    return File(path, str(folder), config["site_dir"], config["use_directory_urls"])


def on_files(files, config):
    docs = pathlib.Path(config["docs_dir"])
    for file in list(files):
        is_page = file.src_uri.endswith(".md") or file.src_uri.startswith("images/")
        if docs in pathlib.Path(file.abs_src_path).parents and not is_page:
            files.remove(file)
    for path in sorted(MADE.rglob("*")):
        name = path.relative_to(MADE)
        if path.is_file() and name.parts[0] in ("api", "assets", "live"):
            files.append(file_of(name.as_posix(), MADE, config))
    for name in sorted(GENERATED):
        files.append(file_of(name, docs, config))
    pending = [(posixpath.dirname(f.src_uri), read_source(f.src_uri) or text_of(docs / f.src_uri))
               for f in files.documentation_pages()]
    while pending:
        folder, text = pending.pop()
        for _, link, _ in LINK.findall(CODE.sub("", text)):
            path = path_in_repository(folder, link)
            target = target_of(path) if path else None
            if target and target.startswith("source/") and target not in files:
                files.append(file_of(target, docs, config))
                pending.append((posixpath.dirname(target), read_source(target)))
    return files


def on_page_read_source(page, config):
    return read_source(page.file.src_uri)


def read_source(name):
    """The text of a page that is not a file of docs/."""
    if name == "index.md":
        return start_page()
    if name == "references.md":
        return references()
    if name == LIVE_PAGE:
        return NO_LIVE_PAGE
    if name.startswith("source/"):
        return source_page(name[len("source/"):-len(".md")])
    return None


def start_page():
    docs = REPOSITORY / "docs"
    # Links of Markdown and HTML, from docs/ instead of the top folder.
    readme = re.sub(r"""(\]\(|\b(?:src|href|poster)=")(?!\w+:|#)([^)\s"]+)""",
                    lambda m: m[1] + posixpath.relpath(m[2], "docs"), text_of(REPOSITORY / "README.md"))
    sections = sections_of(readme)

    def part(match):
        title, _, share = match[1].partition(", ")
        if title not in sections:
            raise PluginError(f".mkdocs/start.md: README has no section '{title}'")
        before, bar, after = sections[title].partition("\n|")
        shares = {"": before + bar + after, "before its table": before, "from its table on": bar + after}
        return shares[share].strip()

    def item(match):
        title, page, text = match.groups()
        pages = pages_of_folder(docs, page) if page.endswith("/") else [page]
        if not pages or (pages[0].endswith(".md") and not (docs / pages[0]).exists()):
            return ""
        return f"- [{title}]({pages[0]}){text}\n"

    text = text_of(REPOSITORY / ".mkdocs" / "start.md")
    text = re.sub(r"^- \[(.*?)\]\((.*?)\)(.*)\n", item, text, flags=re.M)
    return re.sub(r"\{\{ README: (.*?) \}\}", part, text)


def sections_of(text):
    """The text below each heading, up to the next one."""
    sections, title, is_code = {}, "", False
    for line in text.splitlines(keepends=True):
        is_code ^= line.startswith("```")
        if line.startswith("#") and not is_code:
            title = line.strip("# \n")
        else:
            sections[title] = sections.get(title, "") + line
    return sections


def bibliography():
    return pybtex.database.parse_file(str(REPOSITORY / "docs" / "references.bib"))


KEYS = set(bibliography().entries)


def references():
    style = pybtex.plugin.find_plugin("pybtex.style.formatting", "plain")()
    backend = pybtex.plugin.find_plugin("pybtex.backends", "html")()
    data = bibliography()
    lines = ["# References", "", '<dl class="references">']
    for entry in sorted(style.format_entries(data.entries.values()), key=lambda e: e.key.lower()):
        lines.append(f'<dt id="{entry.key.lower()}">{entry.key}</dt>')
        lines.append(f"<dd>{entry.text.render(backend)}</dd>")
    return "\n".join([*lines, "</dl>", ""])


def source_page(name):
    path = REPOSITORY / name
    title = f"---\ntitle: {name}\n---\n\n# `{name}`\n\n"
    if path.is_dir():
        entries = sorted(p for p in path.iterdir() if not p.name.startswith((".", "__")))
        rows = [f"| [{p.name}](/{p.relative_to(REPOSITORY).as_posix()}) | {summary(p)} |" for p in entries]
        return title + "| | |\n|---|---|\n" + "\n".join(rows) + "\n"
    text = text_of(path)
    language = LANGUAGES.get(path.suffix) or ("bash" if text.startswith("#!") else "text")
    if text.startswith("#!") and "python" in text.partition("\n")[0]:
        language = "python"
    fence = "`" * (3 + max(map(len, re.findall("`{3,}", text)), default=0))
    return f"{title}{fence}{language}\n{text.rstrip()}\n{fence}\n"


def summary(path):
    """The first sentence of the comment at the beginning of a file."""
    if path.is_dir():
        return ""
    comment = re.match(r"(?:#!.*\n)?(?://|#) SPDX.*\n(?:#\n)?((?:(?://|#) .*\n|\"\"\".*\n)*)", text_of(path))
    text = re.sub(r"^(?://|#) |\"\"\"", "", comment[1] if comment else "", flags=re.M)
    return html.escape(re.split(r"(?<=\.)\s", text.replace("\n", " "))[0]).replace("|", "\\|")


# --- links ---------------------------------------------------------------------------------------


def path_in_repository(folder, link):
    """The file or folder of the repository to which a link of a page in this folder of docs/ leads,
    if it is no page or picture."""
    if re.match(r"\w+:|#", link):
        return None
    # A link that begins with / is relative to the top folder.
    path = posixpath.normpath(posixpath.join("/docs", folder, link.partition("#")[0])).lstrip("/")
    is_part = path.startswith("docs/images/") or (path.startswith("docs/") and path.endswith(".md"))
    if is_part or not (REPOSITORY / path).exists():
        return None
    return path


def target_of(path):
    """The page of the site for a file or folder of the repository."""
    if path == "README.md":
        return "index.md"
    if path == "docs/references.bib":
        return "references.md"
    if path in ("docs/live", "docs/live/index.html"):
        return LIVE_PAGE
    return API_SOURCES.get(path) or f"source/{path}.md"


def on_page_markdown(markdown, page, config, files):
    docs = pathlib.Path(config["docs_dir"])
    folder = posixpath.dirname(page.file.src_uri)

    def relative(target):
        return posixpath.relpath(target, folder or ".")

    def link(match):
        path = path_in_repository(folder, match[2])
        if path is None:
            return match[0]
        _, mark, anchor = match[2].partition("#")
        return match[1] + relative(target_of(path)) + mark + anchor + match[3]

    def title(match):
        target = posixpath.normpath(posixpath.join(folder, match[2]))
        heading = re.search(r"^# (.*)", read_source(target) or text_of(docs / target), re.M) \
            if target in files else None
        return f"[{heading[1]}]({match[2]}{match[3]})" if heading else match[0]

    def cite(match):
        if match[1] not in KEYS:
            return match[0]
        return f"[\\[{match[1]}\\]]({relative('references.md')}#{match[1].lower()})"

    def mend(text):
        text = re.sub(r"^[ ]*<!-- silt: .*? -->\n", "", text, flags=re.M)
        text = text.replace("\\<", "&lt;").replace("\\>", "&gt;")
        text = re.sub(r"\[([\w/]+\.md)\]\(([^)\s#:]+\.md)((?:#[^)\s]*)?)\)", title, text)
        return re.sub(r"(?<!\\)\[(\w+)\](?![(\[:])", cite, LINK.sub(link, text))

    return outside_code(markdown, mend)


# --- the API reference ---------------------------------------------------------------------------


def read_tags():
    """From the tag file of Doxygen: the pages of names, and those of the sources of headers."""
    names, sources = {}, {}
    for compound in xml.etree.ElementTree.parse(MADE / "api.tag").getroot():
        kind, name, page = compound.get("kind"), compound.findtext("name"), compound.findtext("filename")
        page = page if page.endswith(".html") else page + ".html"
        if kind == "file":
            header = f"include/{compound.findtext('path')}{name}"
            sources[header[header.rindex("include/"):]] = f"api/{page.removesuffix('.html')}_source.html"
        elif kind in ("class", "struct", "concept"):
            names[name] = f"api/{page}"
        if kind in ("namespace", "class", "struct"):
            for member in compound.iter("member"):
                where = f"api/{member.findtext('anchorfile')}#{member.findtext('anchor')}"
                names.setdefault(f"{name}::{member.findtext('name')}", where)
    return names, sources


API_NAMES, API_SOURCES = read_tags()


def api_page(code):
    """The page of the API reference for the text of a code span, if it names something public."""
    name = re.fullmatch(r"(?:silt::)?((?:\w+::)*\w+)(?:<[^()]*>)?(?:\(.*\))?(?:\{.*\})?",
                        html.unescape(code))
    if not name or "_" not in name[1] and not re.search("[A-Z]|::", name[1]):
        return None
    return next((API_NAMES[f"silt::{scope}{name[1]}"] for scope in ("", "dem::", "mps::", "mpi::")
                 if f"silt::{scope}{name[1]}" in API_NAMES), None)


# Parts of HTML that stay as they are, and inline code.
KEPT = re.compile(r"(<pre.*?</pre>|<h\d.*?</h\d>|<a .*?</a>|<div class=\"arithmatex\">.*?</div>"
                  r"|<span class=\"arithmatex\">.*?</span>|<script.*?</script>|<code>.*?</code>|<[^>]*>)", re.S)
SCRIPT = re.compile(r"((?<!\w)\w['̄̂̇*′’]*|⟩|&gt;)_(?:\{([^{}]+)\}|([^\W_²³ᵀ]+(?!\w*_)))"  # a_b, a_{b c}
                    r"|(?<=[\w)\]′'’])\^(?:\{([^{}]+)\}|(−?\w+))")  # a^b, a^{b c}
LATTICE_VALUE = re.compile(r"(?<!\w)([lnN])0(?!\w)")  # l0, n0, N0


def script(match):
    lower, upper = match[2] or match[3], match[4] or match[5]
    return f"{match[1]}<sub>{lower}</sub>" if lower else f"<sup>{upper}</sup>"


def set_scripts(text, mend_code=lambda code: code):
    """HTML with a_b and x^{2} outside code as subscript and superscript."""
    parts = KEPT.split(text)
    parts[::2] = [SCRIPT.sub(script, LATTICE_VALUE.sub(r"\1_0", part)) for part in parts[::2]]
    parts[1::2] = [mend_code(part) if part.startswith("<code>") else part for part in parts[1::2]]
    return "".join(parts)


def on_page_content(content, page, config, files):
    def link(code):
        target = api_page(code.removeprefix("<code>").removesuffix("</code>"))
        return f'<a class="api" href="{get_relative_url(target, page.url)}">{code}</a>' if target else code

    return content if page.file.src_uri.startswith("source/") else set_scripts(content, link)


def on_post_build(config):
    site = pathlib.Path(config["site_dir"])
    leave_sources_out(site / "search" / "search_index.json")
    mend_api(site / "api")


def leave_sources_out(index):
    """Takes the sources out of the search, which would be found for every word of the code."""
    found = json.loads(text_of(index))
    found["docs"] = [part for part in found["docs"] if not part["location"].startswith("source/")]
    index.write_text(json.dumps(found), encoding="utf-8")


def mend_api(api):
    """Puts the top navigation of the site into the pages of the API reference, sets subscripts, and
    mends what Doxygen 1.9.4 gets wrong."""
    here = {True: ' class="here"', False: ""}
    links = [f'<a href="../{address}"{here[address.startswith("api/")]}>{html.escape(title)}</a>'
             for title, address in TABS]
    anchors, group_of = {}, {}
    for path in api.glob("*.html"):
        text = text_of(path)
        text = text.replace("<!-- navigation -->", "".join(links))
        text = re.sub(r"<p>.*?</p>|<td class=\"mdescRight\">.*?</td>", lambda m: set_scripts(m[0]), text,
                      flags=re.S)
        text = text.replace(" Concept Reference</div>", "</div>")
        anchors[path.name] = set(re.findall(r'\b(?:id|name)="([\w-]+)"', text))
        if "nested-classes" not in anchors[path.name]:  # they are private
            text = re.sub(r'<a href="#nested-classes">.*?</a>(?: &#124;\s*)?', "", text)
        path.write_text(text, encoding="utf-8")
        if path.name.startswith("group__"):
            group_of.update(dict.fromkeys(anchors[path.name], path.name))

    # Doxygen's tree looks for the members of a group in the page of their header, and for enumerators
    # and others without a comment, which have no anchor.
    def mend(match):
        page, anchor = match[1], match[2]
        if anchor in anchors.get(page, ()):
            return match[0]
        return f'"{group_of[anchor]}#{anchor}"' if anchor in group_of else f'"{page}"'

    for path in api.glob("*.js"):
        text = re.sub(r'"(\w+\.html)#(\w+)"', mend, text_of(path))
        path.write_text(text, encoding="utf-8")
