#!/usr/bin/env python3
"""Every result of --json against its schema in docs/schemas, and every JUnit file against the form of Ant's.

    check_schemas.py MAIDE FOLDER_OF_PROGRAMS PROJECT

Each command of `maide manual --all` has a schema. The schemas are strict: each member has a description, and what they
do not know is refused. Each case of schema_cases.py is run. Its result fits its schema; with a member removed, renamed,
or of another type it does not. In the end each member must have been printed by a case, and each optional one must have
been absent from a case.
"""
import copy
import json
import os
import shlex
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml
from pathlib import Path

import jsonschema

import schema_cases

MAIDE, PROGRAMS, PROJECT = sys.argv[1:]
PLACES = {"models": PROJECT + "/tests/models", "examples": PROJECT + "/examples", "tests": PROJECT + "/tests",
          "bin": PROGRAMS, "python": sys.executable}
problems = []
used_exceptions = set()  # of schema_cases.NOT_PRINTED


def is_below(label, place):
    return label == place or label.startswith((place + ".", place + "["))


def fill_in(text):
    for name, place in PLACES.items():
        text = text.replace("{" + name + "}", place)
    return text


class Schema:
    """One schema, and what the cases have printed of it."""

    def __init__(self, path):
        self.name = path.stem
        self.text = json.loads(path.read_text(encoding="utf-8"))
        jsonschema.Draft202012Validator.check_schema(self.text)
        self.validator = jsonschema.Draft202012Validator(self.text)
        self.present, self.absent = set(), set()  # (id of an object's schema, member)
        self.tried = set()                        # shapes of results that were spoilt

    def objects(self, schema=None, place=None):
        """Every schema of an object with named members, and its place."""
        schema, place = schema or self.text, place or self.name
        if "properties" in schema:
            yield place, schema
        for member, inner in schema.get("properties", {}).items():
            yield from self.objects(inner, f"{place}.{member}")
        for number, inner in enumerate(schema.get("oneOf", []), 1):
            if "type" in inner:
                yield from self.objects(inner, f"{place}#{number}")
        if "items" in schema:
            yield from self.objects(schema["items"], place + "[]")

    def check_strictness(self):
        for place, schema in self.objects():
            if schema.get("additionalProperties") is not False:
                problems.append(f"{place}: takes members that it does not know")
            for member, inner in schema["properties"].items():
                description = inner.get("description", "")
                if not description:
                    problems.append(f"{place}.{member}: has no description")
                for unit in ("seconds", "bytes"):
                    if unit in member and unit not in description:
                        problems.append(f"{place}.{member}: does not say its unit, {unit}")

    def fits(self, result):
        return self.validator.is_valid(result)

    def walk(self, value, schema=None, way=()):
        """Every object with named members in a result: its way from the root, and its schema."""
        schema = schema or self.text
        for inner in schema.get("oneOf", []):
            if "type" in inner and jsonschema.Draft202012Validator(inner).is_valid(value):
                yield from self.walk(value, inner, way)
        if isinstance(value, dict) and "properties" in schema:
            yield way, schema
            for member, inner in value.items():
                yield from self.walk(inner, schema["properties"][member], (*way, member))
        elif isinstance(value, list) and "items" in schema:
            for index, inner in enumerate(value):
                yield from self.walk(inner, schema["items"], (*way, index))

    def take(self, result, case):
        """A result that a case printed; it and all that is spoilt in it."""
        errors = list(self.validator.iter_errors(result))
        for error in errors:
            best = jsonschema.exceptions.best_match([error])
            problems.append(f"{case}: {best.message[:300]} (at {'.'.join(map(str, best.absolute_path))})")
        if errors:
            return
        for way, schema in self.walk(result):
            here = result
            for part in way:
                here = here[part]
            for member in schema["properties"]:
                (self.present if member in here else self.absent).add((id(schema), member))
            shape = (id(schema), *sorted(here))
            if shape in self.tried:
                continue
            self.tried.add(shape)
            for member in here:
                self.spoil(result, way, member, member in schema.get("required", []), case)

    def spoil(self, result, way, member, is_required, case):
        def spoilt(change):
            other = copy.deepcopy(result)
            here = other
            for part in way:
                here = here[part]
            change(here)
            return other

        place = ".".join(map(str, (*way, member)))
        less = spoilt(lambda here: here.pop(member))
        # What is left may be what every command prints that found nothing.
        if is_required and set(less) != {"schema", "error", "status"} and self.fits(less):
            problems.append(f"{case}: fits without {place}")
        if self.fits(spoilt(lambda here: here.update({member + "_": here.pop(member)}))):
            problems.append(f"{case}: fits with {place} renamed")
        if self.fits(spoilt(lambda here: here.update({member: [{}]}))):
            problems.append(f"{case}: fits with another type of {place}")

    def check_completeness(self):
        for place, schema in self.objects():
            for member in schema["properties"]:
                label = f"{place}.{member}"
                is_printed = (id(schema), member) in self.present
                exceptions = [known for known in schema_cases.NOT_PRINTED if is_below(label, known)]
                used_exceptions.update(exceptions)
                if is_printed and label in exceptions:
                    problems.append(f"{label}: is printed, against NOT_PRINTED")
                elif not exceptions and not is_printed:
                    problems.append(f"{label}: no case prints it")
                elif is_printed and member not in schema.get("required", []):
                    if (id(schema), member) not in self.absent:
                        problems.append(f"{label}: every case prints it, and it is not required")


# ---- JUnit ----

COUNTS = {"tests", "failures", "errors", "skipped", "time"}
# Of each element: its attributes, and its children.
JUNIT = {"testsuites": (COUNTS, {"testsuite"}), "testsuite": (COUNTS | {"name"}, {"properties", "testcase"}),
         "properties": (set(), {"property"}), "property": ({"name", "value"}, set()),
         "testcase": ({"classname", "name"}, {"failure", "skipped", "error"}),
         "failure": ({"message"}, set()), "skipped": ({"message"}, set()), "error": ({"message"}, set())}


def check_junit(path):
    """Elements and attributes are those of the form, and each count is the count of its elements."""
    root = xml.parse(path).getroot()
    if root.tag != "testsuites":
        problems.append(f"{path}: begins with {root.tag}")
    for element in root.iter():
        attributes, children = JUNIT.get(element.tag, (None, None))
        if attributes is None or set(element.attrib) - {"time"} != attributes - {"time"} or {c.tag for c in element} - children:
            problems.append(f"{path}: {xml.tostring(element, encoding='unicode')[:200]}")
    names = [case.get("name") for case in root.iter("testcase")]
    if len(names) != len(set(names)) or any(len(case) > 1 for case in root.iter("testcase")):
        problems.append(f"{path}: a case is there twice, or has two ends")
    found = {"tests": len(names), **{count: len(list(root.iter(tag))) for count, tag in
                                     (("failures", "failure"), ("errors", "error"), ("skipped", "skipped"))}}
    for element in (root, root.find("testsuite")):
        for count, number in found.items():
            if int(element.get(count)) != number:
                problems.append(f"{path}: {count} is {element.get(count)}, and there are {number}")
    return tuple(number > 0 for number in found.values())


# ---- The cases ----

def run_case(line, schemas, commands):
    status, words = line.split(" ", 1)
    if status == "!":
        return subprocess.run(["/bin/sh", "-c", fill_in(words)], check=True)
    arguments = shlex.split(fill_in(words))
    done = subprocess.run([MAIDE, *arguments, "--json"], stdin=subprocess.DEVNULL, capture_output=True, text=True)
    if done.returncode != int(status):
        problems.append(f"{words}: exit status {done.returncode}, not {status}: {done.stderr.strip()}")
    commands.add(arguments[0])
    result = json.loads(done.stdout)
    if result.get("status", done.returncode) != done.returncode:
        problems.append(f"{words}: status is {result['status']}, and it exits with {done.returncode}")
    schemas[arguments[0]].take(result, words)


def main():
    folder = Path(PROJECT) / "docs/schemas"
    schemas = {path.stem: Schema(path) for path in sorted(folder.iterdir())}
    for schema in schemas.values():
        schema.check_strictness()
    with tempfile.TemporaryDirectory() as place:
        os.chdir(place)
        for name, text in schema_cases.FILES.items():
            Path(name).parent.mkdir(exist_ok=True)
            Path(name).write_text(fill_in(text), encoding="utf-8")
        commands = set()
        for line in schema_cases.CASES.strip().splitlines():
            run_case(line, schemas, commands)
        pages = {path.stem.removeprefix("maide-") for path in Path("man").iterdir()} - {"maide"}
        if not pages or commands != pages or set(schemas) != pages | {"trace"}:
            problems.append(f"commands {sorted(pages)}, cases {sorted(commands)}, schemas {sorted(schemas)}")
        for trace in ("trace.json", "lossy.json", "queued.json", "counted.json", "nobody-trace.json"):
            schemas["trace"].take(json.loads(Path(trace).read_text(encoding="utf-8")), trace)
        ends = {check_junit(path) for path in Path(".").glob("*.xml")}
        if not all(any(end[i] for end in ends) for i in range(4)):
            problems.append(f"no JUnit file has a failure, an error, or a case that is skipped: {ends}")
    for schema in schemas.values():
        schema.check_completeness()
    for label in set(schema_cases.NOT_PRINTED) - used_exceptions:
        problems.append(f"{label}: is in NOT_PRINTED, and in no schema")
    print("\n".join(problems) or f"{len(schemas)} schemas fit")
    sys.exit(1 if problems else 0)


main()
