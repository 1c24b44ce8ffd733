#!/usr/bin/env python3
"""A second reader of .oro files, written from format-spec/oro.md alone; numpy and the standard library suffice.

    tools/read_oro FILE [LEVEL]      prints what the file says, and the SHA-256 of each band's cells
    tools/read_oro --vectors FOLDER  reads all conformance vectors; fails when one is read otherwise than it should be

Rejections are ValueErrors that begin with the number of the requirement.
"""

import hashlib
import json
import pathlib
import sys

from container import read


def describe(path, level):
    meta, cells = read(path.read_bytes(), level)
    meta["sha256"] = [hashlib.sha256(band.tobytes()).hexdigest() for band in cells]
    return json.loads(json.dumps(meta, ensure_ascii=False, default=bytes.hex))


if __name__ == "__main__":
    arguments = sys.argv[1:]
    if arguments[0] == "--vectors":
        from vectors import run

        sys.exit(run(pathlib.Path(arguments[1]), describe))
    try:
        found = describe(pathlib.Path(arguments[0]), int((arguments + [0])[1]))
        print(json.dumps(found, indent=1, ensure_ascii=False))
    except ValueError as error:
        sys.exit(f"{arguments[0]}: rejected: {error}")
