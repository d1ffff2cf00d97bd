"""The report as one page that needs nothing else."""

import html

STYLE = """
:root { --ink: #1b1d20; --paper: #fdfdfb; --faint: #d9dad6; --soft: #f2f2ee; --accent: #0072b2; color-scheme: light dark; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e2; --paper: #17181a; --faint: #3a3c40; --soft: #222427; --accent: #56b4e9; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 78rem; padding: 2rem 1.25rem 6rem; background: var(--paper); color: var(--ink); font: 16px/1.55 system-ui, sans-serif; }
h1 { font-size: 2.1rem; margin: 0 0 .3rem; } h2 { margin: 3.5rem 0 .6rem; font-size: 1.5rem; } h3 { margin: 2rem 0 .5rem; } h4 { margin: 1rem 0 .3rem; }
p { max-width: 48rem; } a { color: var(--accent); }
.finding { font-size: 1.12rem; border-left: 3px solid var(--accent); padding-left: .8rem; }
.command, .output { font: 13px/1.5 ui-monospace, monospace; max-width: none; opacity: .85; overflow-wrap: anywhere; margin: .3rem 0; }
nav ul { columns: 2 20rem; padding-left: 1.1rem; }
.scroll { overflow-x: auto; } table { border-collapse: collapse; font-size: 14px; font-variant-numeric: tabular-nums; margin: .6rem 0; }
th, td { padding: .28rem .7rem; border-bottom: 1px solid var(--faint); text-align: left; white-space: nowrap; } td.number { text-align: right; } th { background: var(--soft); }
.plots, .pairs { display: grid; grid-template-columns: repeat(auto-fit, minmax(21rem, 1fr)); gap: 1rem; }
.plot { margin: 0; background: var(--soft); padding: .6rem; border-radius: 6px; } .plot svg { width: 100%; height: auto; } .plot text { fill: var(--ink); font: 13px system-ui, sans-serif; }
.plot .label { font-weight: 600; } .grid { stroke: var(--faint); } .legend { display: flex; flex-wrap: wrap; gap: .2rem .9rem; font-size: 13px; } .legend .key { width: 24px; height: 12px; margin-right: .35rem; vertical-align: -1px; }
.pair { margin: 0; } .slide, .difference { position: relative; overflow: hidden; background: #000; } .slide img, .difference img { display: block; width: 100%; }
.over, .difference img + img { position: absolute; inset: 0; } .over { clip-path: inset(0 0 0 50%); } .difference { filter: brightness(8); isolation: isolate; } .difference img + img { mix-blend-mode: difference; }
.slide input { position: absolute; inset: auto 0 .4rem; width: 100%; margin: 0; accent-color: var(--accent); } figcaption { font-size: 14px; padding: .3rem 0 .8rem; }
.row { grid-column: 1 / -1; } .strip { display: grid; grid-template-columns: repeat(4, 1fr); gap: .6rem; } .strip figure { margin: 0; } .strip img { width: 100%; background: #fff; }
details { margin: .8rem 0; } summary { cursor: pointer; }
@media (max-width: 40rem) { .strip { grid-template-columns: repeat(2, 1fr); } }
"""

SCRIPT = """
for (const input of document.querySelectorAll('.slide input'))
    input.addEventListener('input', () => {
        input.previousElementSibling.style.clipPath = `inset(0 0 0 ${input.value}%)`;
    });
"""


def chapter_html(chapter):
    """chapter: name, title, finding, command, seconds, body and remarks."""
    remarks = "".join(f"<p>{html.escape(remark)}</p>" for remark in chapter.get("remarks", []))
    return (
        f"<section id='{chapter['name']}'><h2>{html.escape(chapter['title'])}</h2>"
        f"<p class=finding>{html.escape(chapter['finding'])}</p>{remarks}{chapter['body']}"
        f"<p class=command>{html.escape(chapter['command'])} &nbsp; {chapter['seconds']:.0f} s, load {chapter['load']:.1f}</p></section>"
    )


def page_html(machine, chapters, skipped):
    links = "".join(f"<li><a href='#{c['name']}'>{html.escape(c['title'])}</a></li>" for c in chapters)
    facts = "; ".join(f"{key}: {value}" for key, value in machine.items())
    left_out = f"<p>Not in this report: {html.escape('; '.join(skipped))}.</p>" if skipped else ""
    return (
        "<!DOCTYPE html><html lang=en><head><meta charset=utf-8><meta name=viewport content='width=device-width, initial-scale=1'>"
        f"<title>Relumine, measured</title><style>{STYLE}</style></head><body><h1>Relumine, measured</h1>"
        f"<p class=command>{html.escape(facts)}</p>{left_out}<nav><ul>{links}</ul></nav>"
        f"{''.join(chapter_html(c) for c in chapters)}<script>{SCRIPT}</script></body></html>\n"
    )
