"""Markdown as the benches print it: tables and lines between them."""

import html
import re


def blocks(text):
    """Returns [(kind, lines)] in order: kind is "table", rows of cells, or "text", lines."""
    result = []
    for line in text.splitlines():
        if line.startswith("|"):
            cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
            if all(re.fullmatch(r":?-+:?", cell) for cell in cells):
                continue
            if not result or result[-1][0] != "table":
                result.append(("table", []))
            result[-1][1].append(cells)
        elif line.strip():
            if not result or result[-1][0] != "text":
                result.append(("text", []))
            result[-1][1].append(line.rstrip())
        elif result and result[-1][0] == "table":
            result.append(("text", []))
    return [(kind, lines) for kind, lines in result if lines]


def tables(text):
    return [lines for kind, lines in blocks(text) if kind == "table"]


def data_rows(text):
    """Returns the rows of all tables, without their heads."""
    return [row for table in tables(text) for row in table[1:]]


def is_number(cell):
    return re.match(r"[-+]?[0-9.]+(e[-+]?\d+)?( ?(%|x|s|ms|us|min|MB|GB|M|G|h))?$", cell) is not None


def table_html(rows):
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in rows[0])
    body = []
    for row in rows[1:]:
        cells = "".join(
            f"<td{' class=number' if is_number(cell) else ''}>{html.escape(cell)}</td>" for cell in row
        )
        body.append(f"<tr>{cells}</tr>")
    return f"<div class=scroll><table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table></div>"


def markdown_html(text):
    parts = []
    for kind, lines in blocks(text):
        if kind == "table":
            parts.append(table_html(lines))
            continue
        for line in lines:
            if line.startswith("#"):
                parts.append(f"<h3>{html.escape(line.lstrip('# '))}</h3>")
            else:
                parts.append(f"<p class=output>{html.escape(line)}</p>")
    return "\n".join(parts)


def first(pattern, text, group=1):
    """Returns what a pattern matches first in the text, None where it does not."""
    found = re.search(pattern, text)
    return found.group(group) if found else None
