"""Whether tests see faults: puts each fault of `seeded_faults.toml` into a scratch copy, and runs the test that must fail.

    python validation/seeded_faults.py                 all of them: an hour or two
    python validation/seeded_faults.py bussi judge     the faults whose file or test has one of these words
    python validation/seeded_faults.py --copy FOLDER   in a copy that stays, so that the next call compiles less

The copy is a worktree of the last commit. A fault is *caught* where its test passes without the fault and fails with it. It needs the
standard library alone.
"""

import argparse
import shlex
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIST = Path(__file__).with_suffix(".toml")


def faults():
    """The list, in its order."""
    with open(LIST, "rb") as file:
        return tomllib.load(file)["fault"]


def seeded(text, fault):
    """A source with the fault in it."""
    if text.count(fault["text"]) != 1:
        raise ValueError(f"{fault['file']} has `{fault['text']}` {text.count(fault['text'])} times; wanted: once")
    return text.replace(fault["text"], fault["replacement"])


def outcome(copy, fault):
    """`passes`, `fails`, `runs nothing` or `does not compile`, of the fault's test in the copy as it is."""
    command = ["cargo", "test", *shlex.split(fault["test"])]
    ran = subprocess.run(command, cwd=copy, capture_output=True, text=True)
    if "could not compile" in ran.stderr:
        return "does not compile"
    if " passed" in ran.stdout and ran.stdout.count(" 0 passed; 0 failed") == ran.stdout.count("test result:"):
        return "runs nothing"
    return "passes" if ran.returncode == 0 else "fails"


def verdict(copy, fault, passing):
    """What the test says of the fault; `passing` holds the tests that passed without any."""
    if fault["test"] not in passing:
        before = outcome(copy, fault)
        if before != "passes":
            return f"its test {before} without the fault"
        passing.add(fault["test"])
    source = copy / fault["file"]
    good = source.read_text(encoding="utf-8")
    try:
        source.write_text(seeded(good, fault), encoding="utf-8")
        found = outcome(copy, fault)
    finally:
        source.write_text(good, encoding="utf-8")
    return "caught" if found == "fails" else f"NOT caught: its test {found}"


def main():
    reader = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    reader.add_argument("words", nargs="*", help="faults whose file or test has one of these words")
    reader.add_argument("--copy", type=Path, help="a folder for the copy, which stays")
    arguments = reader.parse_args()
    chosen = [f for f in faults() if not arguments.words or any(w in f["file"] + f["test"] for w in arguments.words)]
    if not chosen:
        sys.exit(f"no fault has one of the words {arguments.words}; allowed: words of {LIST.name}")
    copy = arguments.copy or Path(tempfile.mkdtemp()) / "copy"
    git = ["git", "-C", ROOT, "worktree"]
    if not copy.exists():
        subprocess.run([*git, "add", "--detach", copy, "HEAD"], check=True, capture_output=True)
    missed, passing = 0, set()
    for fault in chosen:
        start = time.monotonic()
        said = verdict(copy, fault, passing)
        missed += said != "caught"
        print(f"{said:<12}{time.monotonic() - start:7.0f} s  {fault['file']}: {fault['replacement']}", flush=True)
    print(f"{len(chosen) - missed} of {len(chosen)} faults are caught")
    if arguments.copy is None:
        subprocess.run([*git, "remove", "--force", copy], check=True)
    sys.exit(missed > 0)


if __name__ == "__main__":
    main()
