#!/usr/bin/env python3
"""Plays a page of `maide compare --html` or `maide test --html` without a browser.

    step_through.py NODE PAGE KEY,KEY,...

The page is parsed strictly: every element is closed, no id comes twice, nothing is loaded from
elsewhere. Its script runs under Node with a document that has the page's ids and nothing else.
PAGE#2.5 is a link to step 5 of difference 2. Prints a line for the start and for each key: where it
says it is, the cells of the marked row, and for each side the text of the marked state of the
picture.
"""
import html.parser
import json
import subprocess
import sys

VOID = {"meta", "br", "path", "ellipse", "polygon"}

DOCUMENT = r"""
const page = JSON.parse(require("fs").readFileSync(0, "utf8"));
const elements = new Map(Object.keys(page.texts).map((id) => {
  const classes = new Set(page.classes[id]);
  const element = {id, textContent: page.texts[id], hidden: page.hidden.includes(id), open: false,
    heard: {}, addEventListener(kind, act) { this.heard[kind] = act; }, scrollBy() {},
    getBoundingClientRect: () => ({left: 0, top: 0, width: 0, height: 0}),
    classList: {toggle(name, on = !classes.has(name)) { on ? classes.add(name) : classes.delete(name); },
                contains: (name) => classes.has(name)}};
  return [id, element];
}));
let onKey = () => {};
const document = {getElementById: (id) => elements.get(id) || null,
                  addEventListener: (kind, act) => { if (kind === "keydown") onKey = act; }};
new Function("document", "location", page.script)(document, {hash: page.hash});
const marked = (name) => [...elements.values()].filter((one) => one.classList.contains(name));
function tell(key) {
  const states = (side) => marked("at")
      .filter((one) => one.id[0] === "n" && !one.classList.contains(side))
      .map((one) => one.textContent.trim());
  const row = marked("now");
  if (row.length !== 1) throw new Error("rows marked: " + row.length);
  console.log(key + ": " + elements.get("where").textContent + " | " +
              page.cells[row[0].id].join(" ; ") + " | A at " + states("at-right").join("+") +
              ", B at " + states("at-left").join("+"));
}
if (elements.get("controls").hidden) throw new Error("the controls are hidden");
tell("start");
for (const key of page.keys) {
  if (key[0] === "#") {
    elements.get(key.slice(1)).heard.click();
  } else {
    onKey({key, preventDefault() {}});
  }
  tell(key);
}
"""


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.texts, self.classes, self.hidden = [], {}, {}, []
        self.cells, self.scripts = {}, []

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        for name, value in attributes:
            if name in ("src", "xlink:href", "href") or (value and "url(" in value):
                raise SystemExit(f"the page loads {value} at {self.getpos()}")
        if "id" in given:
            if given["id"] in self.texts:
                raise SystemExit(f"the id {given['id']} comes twice")
            self.texts[given["id"]] = ""
            self.classes[given["id"]] = (given.get("class") or "").split()
            if "hidden" in given:
                self.hidden.append(given["id"])
        if tag == "td":
            self.cells.setdefault(self.row(), []).append("")
        if tag == "script":
            self.scripts.append("")
        if tag not in VOID:
            self.open.append((tag, given.get("id")))

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open[-1][0] != tag:
            raise SystemExit(f"</{tag}> closes {self.open[-1:]} at {self.getpos()}")
        self.open.pop()

    def handle_data(self, data):
        for _, name in self.open:
            if name:
                self.texts[name] += data.replace("\n", " ") if self.open[-1][0] == "text" else ""
        if any(tag == "td" for tag, _ in self.open):
            self.cells[self.row()][-1] += data
        if self.open and self.open[-1][0] == "script":
            self.scripts[-1] += data
            if self.open[-1][1]:
                self.texts[self.open[-1][1]] = self.scripts[-1]
        if self.open and self.open[-1][0] == "text":
            for _, name in self.open:
                if name:
                    self.texts[name] += " "

    def row(self):
        rows = [name for tag, name in self.open if tag == "tr"]
        return (rows[-1] if rows else None) or "none"


def main():
    node, path, keys = sys.argv[1:]
    path, _, place = path.partition("#")
    page = Page()
    page.feed(open(path, encoding="utf-8").read())
    page.close()
    if page.open:
        raise SystemExit(f"never closed: {page.open}")
    result = subprocess.run([node, "-e", DOCUMENT], text=True, check=False, stdout=subprocess.PIPE,
                            input=json.dumps({
                                "texts": page.texts, "classes": page.classes, "hidden": page.hidden,
                                "cells": page.cells, "hash": "#" + place, "script": page.scripts[-1],
                                "keys": [key for key in keys.split(",") if key]}))
    print(result.stdout, end="")
    return result.returncode


if __name__ == "__main__":
    sys.exit(main())
