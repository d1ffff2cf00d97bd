"""The site of the documentation: `./dev docs` builds it from the pages in docs/, the docstrings of
the Python package and the comments of the public headers. Nothing is fetched."""

import os
import re
import subprocess
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "../.."))
BUILD = os.environ["RELUMINE_SITE_BUILD"]  # a folder for what doxygen writes
sys.path.insert(0, os.environ["RELUMINE_PYTHON"])  # the built package

project = "Relumine"
author = "Relumine developers"
copyright = "Relumine developers, Apache-2.0"
with open(os.path.join(ROOT, "pyproject.toml")) as file:
    version = release = re.search(r'^version = "(\S+)"', file.read(), re.MULTILINE)[1]

extensions = ["myst_parser", "sphinx.ext.autodoc", "breathe"]
root_doc = "docs/site/index"
include_patterns = ["*.md", "docs/*.md", "docs/site/*.md"]
exclude_patterns = ["build", "tests", "demo"]
html_theme = "furo"
html_title = "Relumine"
html_baseurl = ""
myst_heading_anchors = 4
autodoc_member_order = "bysource"
autodoc_typehints = "none"
nitpicky = False
pygments_style = "friendly"
highlight_language = "none"

# The C++ door: the headers of relumine/, and those whose types stand in its signatures.
breathe_projects = {"relumine": os.path.join(BUILD, "xml")}
breathe_default_project = "relumine"
breathe_show_include = False


def run_doxygen():
    os.makedirs(BUILD, exist_ok=True)
    settings = f"""
        INPUT = {ROOT}/relumine {ROOT}/mesh {ROOT}/cubemap {ROOT}/lights {ROOT}/prt {ROOT}/relight {ROOT}/files
        RECURSIVE = YES
        FILE_PATTERNS = *.h
        EXCLUDE = {ROOT}/relumine/in/stages.h
        OUTPUT_DIRECTORY = {BUILD}
        GENERATE_HTML = NO
        GENERATE_LATEX = NO
        GENERATE_XML = YES
        XML_PROGRAMLISTING = NO
        DOT_GRAPH_MAX_NODES = 500
        EXTRACT_ALL = YES
        ENABLE_PREPROCESSING = YES
        MACRO_EXPANSION = YES
        QUIET = YES
        WARN_IF_UNDOCUMENTED = NO
    """
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)


run_doxygen()


def lines_of_a_docstring(app, what, name, thing, options, lines):
    """Docstrings are plain text: what is indented or lies in columns stays as it is."""
    result, block = [], []

    def flush():
        if block:
            if any(line.startswith(" ") or re.search(r"\S {2,}\S", line) for line in block):
                if all(line.startswith(">>>") for line in block[:1]):
                    result.extend(block)
                else:
                    result.extend(["::", "", *("    " + line for line in block)])
            else:
                result.extend(block)
            result.append("")
            block.clear()

    for line in lines:
        if line.strip():
            block.append(line)
        else:
            flush()
    flush()
    lines[:] = result


FOLDER_LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]+)\)")


def links_to_sources(app, name, source):
    """Links to files that are no pages become the file's name: a site has no sources."""
    folder = os.path.dirname(os.path.join(ROOT, name))

    def replaced(match):
        target = os.path.normpath(os.path.join(folder, match[1]))
        is_page = target.endswith(".md") and os.path.exists(target)
        if is_page or target.endswith((".png", ".svg")):
            return match[0]
        if not os.path.exists(target):
            raise ValueError(f"{name}: expected a link to a file, got {match[1]}")
        return "]{.source}"

    text = FOLDER_LINK.sub(replaced, source[0])
    source[0] = re.sub(r"\[([^\]]+)\]\{\.source\}", r"`\1`", text)


def setup(app):
    app.connect("autodoc-process-docstring", lines_of_a_docstring)
    app.connect("source-read", links_to_sources)
