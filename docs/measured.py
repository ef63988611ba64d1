"""What the scripts that fill the pages share: the program, its answers kept, the places of tables. Standard library only.

GRADWRIGHT in the environment names another program than ./gradwright.
"""
import json
import os
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
DOCS = os.path.join(ROOT, "docs")
PROGRAM = os.environ.get("GRADWRIGHT", "./gradwright")


def sets(values):
    """`--set` before each of them."""
    return [word for value in values for word in ("--set", value)]


def shown(words):
    """The call as a reader would type it."""
    return "./gradwright " + " ".join(map(shlex.quote, words))


def ran(words):
    """The finished process of a call, its stdout kept; what it is doing goes to the terminal."""
    print("running:", shown(words), file=sys.stderr, flush=True)
    return subprocess.run([PROGRAM, *words], cwd=ROOT, stdout=subprocess.PIPE)


def said(words, good=(0,)):
    """What the program wrote on stdout, in bytes; ends this script on an exit code that is not in `good`."""
    done = ran(words)
    if done.returncode not in good:
        sys.exit(f"gradwright {' '.join(words)} ended with exit code {done.returncode}")
    return done.stdout


def answer(kept, words, good=(0,), writes=False):
    """The JSON of `kept`; where it is not there yet the program is run first. `writes`: the run itself writes `kept`, else
    what it says on stdout is kept."""
    if not os.path.exists(kept):
        os.makedirs(os.path.dirname(kept), exist_ok=True)
        told = said(words, good)
        if not writes:
            with open(kept, "wb") as file:
                file.write(told)
    with open(kept) as file:
        return json.load(file)


def put(page, name, table):
    """Writes a table into its place on a page: between `<!-- NAME: begin -->` and `<!-- NAME: end -->`."""
    with open(page) as file:
        text = file.read()
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    if begin not in text or end not in text:
        sys.exit(f"{page} has no place for the table '{name}'")
    head, rest = text.split(begin)
    with open(page, "w") as file:
        file.write(head + begin + "\n" + table + "\n" + end + rest.split(end)[1])


def fill(page, tables):
    """The tables named on the command line, or all: `tables` has for each name a function without arguments. Each is written as
    it comes, for the next may take an hour."""
    wanted = [word for word in sys.argv[1:] if not word.startswith("--")] or list(tables)
    unknown = [name for name in wanted if name not in tables]
    if unknown:
        sys.exit(f"there is no table '{unknown[0]}'; choose from {', '.join(tables)}")
    for name in wanted:
        put(page, name, tables[name]())
