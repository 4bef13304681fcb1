#!/usr/bin/python3
"""Runs a page of docs/ as it stands and compares what its commands print.

  run_page.py BIN PAGE            fails with what differs
  run_page.py BIN PAGE --update   writes what is printed into the page instead

BIN is the folder of the programs; it comes first in PATH. All commands run in one
shell, in an empty folder that has the project's examples/. In the page

- a block whose first line begins with "$ " is a session: commands, each followed by
  what it prints. A command that ends with & goes on until the end;
- a comment before a block says more: <!-- file: NAME --> writes the block to a file,
  <!-- not run: REASON --> leaves it out. Other blocks are no sessions.

Lines are compared without their numbers, which differ from machine to machine and
from day to day, and "..." stands for any lines. A variable that the page exports as
/path/to/NAME is the folder NAME of TACTUS_DATA_DIR, or of ../shared/data beside the
project; without it the page is not run (exit status 77).
"""

import os
import re
import signal
import subprocess
import sys
import tempfile

PROJECT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
DATA = os.environ.get("TACTUS_DATA_DIR") or os.path.join(PROJECT, "../shared/data")
SEPARATOR = "--- end of command"


def blocks(lines):
    """Yields (first, end, comment) of the lines within each fenced block."""
    first = comment = None
    for i, line in enumerate(lines):
        if line.startswith("```"):
            if first is None:
                first = i + 1
                before = lines[i - 1] if i > 0 else ""
                found = re.fullmatch(r"<!-- (.*) -->", before.strip())
                comment = found.group(1) if found else ""
            else:
                yield first, i, comment
                first = None


def sessions(lines):
    """Yields [command, first, end] with the lines of its output."""
    for first, end, comment in blocks(lines):
        if comment.startswith("not run: ") or not lines[first].startswith("$ "):
            continue
        starts = [i for i in range(first, end) if lines[i].startswith("$ ")]
        for start, next_start in zip(starts, starts[1:] + [end]):
            yield [lines[start][2:], start + 1, next_start]


def numberless(line):
    number = r"[0-9a-f]{64}|[0-9][0-9,.:]*(?:e-?[0-9]+)?"
    return re.sub(r"\s+", " ", re.sub(number, "#", line)).strip()


def matches(expected, printed):
    """As equal lists of lines, where "..." stands for any lines."""
    if not expected:
        return not printed
    if expected[0] == "...":
        return any(matches(expected[1:], printed[i:]) for i in range(len(printed) + 1))
    return bool(printed) and numberless(expected[0]) == numberless(printed[0]) and \
        matches(expected[1:], printed[1:])


def prepare(page, lines, folder):
    """Writes the page's files; returns its variables, or None without the data."""
    os.symlink(os.path.join(PROJECT, "examples"), os.path.join(folder, "examples"))
    for first, end, comment in blocks(lines):
        if comment.startswith("file: "):
            with open(os.path.join(folder, comment[6:]), "w") as out:
                out.write("\n".join(lines[first:end]) + "\n")
    variables = {}
    for line in lines:
        found = re.fullmatch(r"export ([A-Z0-9]+)=/path/to/(\w+)", line)
        if found:
            variables[found.group(1)] = os.path.realpath(os.path.join(DATA, found.group(2)))
            if not os.path.isdir(variables[found.group(1)]):
                print(f"{page}: not run: there is no {variables[found.group(1)]}")
                return None
    return variables


def run(commands, environment, folder):
    """What each command prints, as lists of lines."""
    script = "".join(f"{command}\necho; echo '{SEPARATOR}'\n" for command in commands)
    shell = subprocess.Popen(["bash"], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, cwd=folder, env=environment, text=True,
                             start_new_session=True)
    shell.stdin.write(script)
    shell.stdin.close()
    printed, current = [], []
    for line in shell.stdout:
        if line.rstrip("\n") == SEPARATOR:
            current.pop()  # the empty line before the separator
            while current and not current[-1]:
                current.pop()
            printed.append(current)
            current = []
            if len(printed) == len(commands):
                break
        else:
            current.append(line.rstrip("\n"))
    os.killpg(shell.pid, signal.SIGTERM)
    shell.wait()
    return printed


def main(programs, page, update):
    with open(page) as file:
        lines = file.read().split("\n")
    with tempfile.TemporaryDirectory() as folder:
        variables = prepare(page, lines, folder)
        if variables is None:
            return 77
        found = list(sessions(lines))
        environment = dict(os.environ, **variables)
        environment["PATH"] = os.path.realpath(programs) + ":" + environment["PATH"]
        printed = run([command for command, _, _ in found], environment, folder)
    failures = 0
    for (command, first, end), now in reversed(list(zip(found, printed))):
        if matches(lines[first:end], now):
            continue
        if update:
            lines[first:end] = now
            continue
        failures += 1
        print(f"{page}:{first}: $ {command}")
        print("".join(f"  - {line}\n" for line in lines[first:end]) +
              "".join(f"  + {line}\n" for line in now), end="")
    if update:
        with open(page, "w") as file:
            file.write("\n".join(lines))
    print(f"{page}: {len(found)} commands were run, {failures} print something else")
    for first, _, comment in blocks(lines):
        if comment.startswith("not run: "):
            print(f"{page}:{first}: {comment}")
    return 1 if failures or len(printed) < len(found) else 0


sys.exit(main(sys.argv[1], sys.argv[2], "--update" in sys.argv[3:]))
