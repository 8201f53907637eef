"""Parts of a suite on many machines that share a folder: a part leaves a mark when it is whole, and the join looks for all marks."""

import argparse
import json
import os
import sys


def number_of(text):
    """K/N, K from 1 to N."""
    k, _, n = text.partition("/")
    if not (k.isdigit() and n.isdigit() and 1 <= int(k) <= int(n)):
        raise argparse.ArgumentTypeError(f"{text}: wanted is K/N with K from 1 to N: 1/16 is the first part, 16/16 the last")
    return int(k), int(n)


def add_to(parser):
    parser.add_argument("--partition", type=number_of, metavar="K/N", help="make and diagnose part K of N only, into a shared --out")
    parser.add_argument("--join", type=int, metavar="N", help="score the N parts that other calls made, with the same other arguments")


def passed_on(arguments):
    return ["--partition", "{}/{}".format(*arguments.partition)] if arguments.partition else []


def mark(out, part, of):
    return out / "parts" / f"{part}-of-{of}.json"


def finish(out, partition, asked):
    """The mark of a part, by a rename: with what was asked for."""
    file = mark(out, *partition)
    file.parent.mkdir(parents=True, exist_ok=True)
    new = file.with_suffix(f".{os.getpid()}")
    new.write_text(json.dumps(asked))
    new.replace(file)


def require_all(out, of, asked):
    """Ends the program with status 2 unless all parts are there and were asked for the same."""
    missing = [part for part in range(1, of + 1) if not mark(out, part, of).is_file()]
    if missing:
        sys.stderr.write(f"{out}: of {of} parts these are missing: {', '.join(map(str, missing))}\n")
        sys.exit(2)
    for part in range(1, of + 1):
        made = json.loads(mark(out, part, of).read_text())
        if made != asked:
            sys.stderr.write(f"{mark(out, part, of)}: made with {made}, and now {asked} is asked for\n")
            sys.exit(2)
