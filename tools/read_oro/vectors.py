"""Reads the conformance vectors and compares with their descriptions."""

import json

import passes
from basics import SEEN

# What the accepted vectors together have to show of the codec.
FEATURES = {
    "whole", "grid", "fixed", "ordered", "list", "factor", "own void", "patches", "32-bit words", "64-bit words",
    "coarse errors", "very coarse errors", "coarseness written out", "copies", "copies beside voids",
    "copies in a serial pass", "copies in 64-bit words", "no symbols", "serial beside not serial", "serial",
    "not serial", "filter of the set", "own filters", "two classes", "error weights of the set", "own error weights",
    "zones beside voids", "zones in a serial pass", "zones in a pass that is not serial", "4 zones", "shape 0", "shape 1",
    "escape", "raw bits", "run of voids", "1 state", "4 states", "8 states",
}


def worked(folder, describe):
    """What the specification should say of the residuals of one tile."""
    passes.TRACE = []
    describe(folder / "accept/two-by-two.oro", 0)
    rows, passes.TRACE = passes.TRACE, None
    lines = [f"| {kind} | {' | '.join(map(str, row))} |" for kind, row in zip("CHV", rows)]
    specification = (folder.parent / "oro.md").read_text()
    return [f"oro.md should say: {line}" for line in lines if line not in specification]


def run(folder, describe):
    """0 when all are read as they should be."""
    faults = []
    accepted, rejected = sorted((folder / "accept").glob("*.oro")), sorted((folder / "reject").glob("*.oro"))
    for path in accepted:
        expected = json.loads(path.with_suffix(".json").read_text())
        for level, hashes in expected.pop("sha256").items():
            try:
                found = describe(path, int(level))
            except ValueError as error:
                found = {"rejected": str(error), "sha256": None}
            if found.pop("sha256") != hashes:
                faults.append(f"{path.name}: other cells at level {level}")
            wrong = [name for name in expected if name != "about" and found.get(name) != expected[name]]
            if wrong or not found.get("hash"):
                faults.append(f"{path.name}: {wrong or 'hash'}: {found}")
                break
    seen = set(SEEN)
    for path in rejected:
        expected = json.loads(path.with_suffix(".json").read_text())["requirement"]
        try:
            describe(path, 0)
            faults.append(f"{path.name}: accepted")
        except ValueError as error:
            if str(error) != expected:
                faults.append(f"{path.name}: rejected by {error}")
    if not accepted or not rejected:
        faults.append(f"{folder}: no vectors")
    faults += worked(folder, describe)
    faults += [f"no accepted vector shows: {feature}" for feature in sorted(FEATURES - seen)]
    print(*faults, f"{len(accepted)} accepted and {len(rejected)} rejected vectors, {len(faults)} faults", sep="\n")
    return int(bool(faults))
