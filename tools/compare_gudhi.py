#!/usr/bin/env python3
"""Does orograph find the pairs (peak elevation, key saddle elevation) that persistent homology finds?

    orograph peaks DEM.tif peaks.csv --layers peaks --min-prominence 0 --no-isolation
    tools/compare_gudhi.py DEM.tif peaks.csv

The second, independent opinion is GUDHI's (`pip install gudhi`): the finite pairs of 0-dimensional superlevel-set
persistence, roots and pairs of zero height aside. The multisets must be equal, to the last bit of the elevations.
Exit code 0: equal; 1: they differ; 2: the comparison could not be made.

GUDHI filters from below, so the elevations are negated. Of its two cubical complexes the one made from
top-dimensional cells is the one whose sublevel sets connect cells over corners (8 neighbours); the one made from
vertices connects over sides only. `--self-test` checks that, and everything else here, against a plain union-find.
"""

import argparse
import collections
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

METRES = {
    "": 1.0, "m": 1.0, "metre": 1.0, "meter": 1.0, "metres": 1.0, "meters": 1.0, "km": 1000.0, "cm": 0.01,
    "ft": 0.3048, "foot": 0.3048, "feet": 0.3048, "us-ft": 1200 / 3937, "us survey foot": 1200 / 3937,
}
ENVI_TYPES = {1: "u1", 2: "i2", 3: "i4", 4: "f4", 5: "f8", 12: "u2", 13: "u4"}


def fail(message):
    """Ends with the code for a comparison that could not be made."""
    print(f"compare_gudhi: {message}", file=sys.stderr)
    sys.exit(2)


def gudhi_pairs(heights, wraps):
    """Finite pairs (birth, death) with birth above death; `heights` in float64, voids are -inf."""
    import gudhi

    cells = -heights
    if wraps:
        complex_ = gudhi.PeriodicCubicalComplex(top_dimensional_cells=cells, periodic_dimensions=[False, True])
    else:
        complex_ = gudhi.CubicalComplex(top_dimensional_cells=cells)
    complex_.compute_persistence(homology_coeff_field=2, min_persistence=0)
    pairs = np.asarray(complex_.persistence_intervals_in_dimension(0)).reshape(-1, 2)
    # Components that only voids join never meet: their pairs end at infinity, as the roots' do.
    return -pairs[np.isfinite(pairs).all(axis=1) & (pairs[:, 0] < pairs[:, 1])]


def plain_pairs(heights, wraps):
    """The same by a sweep with a union-find over the 8 neighbours; for small grids."""
    rows, cols = heights.shape
    top = {}
    parent = {}

    def find(cell):
        while parent[cell] != cell:
            cell = parent[cell]
        return cell

    pairs = []
    cells = [(r, c) for r in range(rows) for c in range(cols) if heights[r, c] > -np.inf]
    for cell in sorted(cells, key=lambda rc: (-heights[rc], rc)):
        parent[cell] = cell
        top[cell] = heights[cell]
        for dr in (-1, 0, 1):
            for dc in (-1, 0, 1):
                near = (cell[0] + dr, (cell[1] + dc) % cols if wraps else cell[1] + dc)
                if near == cell or near not in parent:
                    continue
                a, b = find(near), find(cell)
                if a == b:
                    continue
                if top[a] < top[b]:
                    a, b = b, a
                if top[b] > heights[cell]:
                    pairs.append((top[b], heights[cell]))
                parent[b] = a
    return np.array(pairs, dtype=np.float64).reshape(-1, 2)


def run(*command):
    """The output of a command, or the end."""
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout
    except FileNotFoundError:
        fail(f"{command[0]} is not installed; it comes with GDAL")
    except subprocess.CalledProcessError as error:
        fail(f"{' '.join(command)}: {error.stderr.strip()}")


def read_values(dem, band, workdir):
    """The band as stored, as numpy array."""
    raw = Path(workdir) / "dem.envi"
    run("gdal_translate", "-q", "-of", "ENVI", "-b", str(band), str(dem), str(raw))
    header = {}
    for line in raw.with_suffix(".hdr").read_text().splitlines():
        key, _, value = line.partition("=")
        header[key.strip()] = value.strip()
    if int(header["byte order"]) != 0:
        fail("the raw dump is not little-endian")
    kind = np.dtype("<" + ENVI_TYPES[int(header["data type"])])
    return np.fromfile(raw, dtype=kind).reshape(int(header["lines"]), int(header["samples"]))


def columns_wrap(info, values, tell=True):
    """Whether the columns span 360 degrees; the values without a repeated last column."""
    wkt = info.get("coordinateSystem", {}).get("wkt", "")
    step = abs(info.get("geoTransform", [0, 0])[1])
    cols = values.shape[1]
    if not wkt.startswith(("GEOGCRS", "GEOGCS")) or step == 0 or cols < 4:
        return False, values
    around = 360.0 / step
    if abs(cols - around) < 0.01:
        return True, values
    if abs(cols - 1 - around) < 0.01:
        if tell:
            print("the last column repeats the first and is dropped")
        return True, values[:, :-1]
    return False, values


def read_dem(path, args, workdir):
    """Heights as float64 in stored units with voids at -inf, upside up; wrap; and the way to metres."""
    info = json.loads(run("gdalinfo", "-json", str(path)))
    band = info["bands"][args.band - 1]
    values = read_values(path, args.band, workdir)
    wraps, values = columns_wrap(info, values)
    if args.wrap is not None:
        wraps = args.wrap
    void = np.isnan(values) if values.dtype.kind == "f" else np.zeros(values.shape, bool)
    nodata = args.nodata if args.nodata is not None else band.get("noDataValue")
    if nodata is not None and nodata != "nan":
        void |= values == values.dtype.type(nodata)
    scale, offset = float(band.get("scale", 1.0)), float(band.get("offset", 0.0))
    unit = (args.vertical_unit or band.get("unit") or "").lower()
    if unit not in METRES:
        fail(f"the unit '{unit}' is unknown; say which with --vertical-unit")
    heights = values.astype(np.float64) * (-1.0 if scale < 0 else 1.0)
    heights[void] = -np.inf

    def metres(pairs):
        return (pairs * (-1.0 if scale < 0 else 1.0) * scale + offset) * METRES[unit]

    return heights, wraps and heights.shape[1] >= 3, metres


def read_peaks(path):
    """Pairs in metres of the peaks that are no roots and have a positive prominence; and how many rows there were."""
    pairs = []
    count = 0
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            count += 1
            if row["is_root"].strip().lower() in ("1", "true", "t", "yes"):
                continue
            pair = (float(row["elevation_m"]), float(row["key_saddle_elevation_m"]))
            if pair[0] > pair[1]:
                pairs.append(pair)
    return np.array(pairs, dtype=np.float64).reshape(-1, 2), count


def multiset(pairs):
    """Pairs as a multiset; one zero only."""
    return collections.Counter(map(tuple, (pairs + 0.0).tolist()))


def verdict(expected, found):
    """Prints how two multisets of pairs compare; whether they are equal."""
    missing, extra = expected - found, found - expected
    if not missing and not extra:
        print(f"equal: {found.total()} pairs of positive prominence")
        return True
    print(f"DIFFERENT: {missing.total()} pairs are missing, {extra.total()} should not be there")
    print(f"  GUDHI has {expected.total()} pairs, orograph {found.total()}")
    for name, pairs in (("missing", missing), ("extra", extra)):
        # The greatest prominences first: they tell most.
        for (peak, saddle), times in sorted(pairs.items(), key=lambda item: item[0][1] - item[0][0])[:10]:
            print(f"  {name}: peak {peak!r} m, saddle {saddle!r} m, prominence {peak - saddle!r} m, {times} times")
    return False


def self_test():
    """GUDHI's pairs against the union-find's on random grids; and the reading of a CSV."""
    corner = np.array([[5.0, 0, 0], [0, 4, 0], [0, 0, 0]])
    assert len(gudhi_pairs(corner, False)) == 0, "cells that touch at a corner are neighbours"
    seam = np.array([[5.0, 0, 3, 0, 4]] * 2)
    assert multiset(gudhi_pairs(seam, False)) == {(4, 0): 1, (3, 0): 1}
    assert multiset(gudhi_pairs(seam, True)) == {(3, 0): 1}, "the last column is a neighbour of the first"
    dice = np.random.default_rng(1)
    for case in range(2000):
        rows, cols = dice.integers(1, 9, size=2)
        heights = dice.integers(0, [2, 4, 9, 1000][case % 4], size=(rows, cols)).astype(np.float64)
        heights[dice.random((rows, cols)) < [0, 0, 0.1, 0.5][case // 4 % 4]] = -np.inf
        wraps = bool(case % 3 == 0 and cols >= 3)
        expected, found = multiset(plain_pairs(heights, wraps)), multiset(gudhi_pairs(heights, wraps))
        assert expected == found, f"wraps: {wraps}\n{heights}\n{expected}\n{found}"
    with tempfile.TemporaryDirectory() as workdir:
        table = Path(workdir) / "peaks.csv"
        table.write_text(
            "id,elevation_m,prominence_m,is_root,key_saddle_elevation_m\n"
            "1,9,9,true,\n2,7.5,4.5,false,3\n3,5,0,false,5\n"
        )
        pairs, count = read_peaks(table)
        assert (pairs.tolist(), count) == ([[7.5, 3.0]], 3)
    assert verdict(multiset(pairs), multiset(pairs))
    assert not verdict(multiset(pairs), multiset(pairs + 1e-9)), "to the last bit"
    degrees = {"coordinateSystem": {"wkt": "GEOGCRS["}, "geoTransform": [-180, 45, 0, 90, 0, -45]}
    for cols, expected in ((8, (True, 8)), (9, (True, 8)), (7, (False, 7))):
        wraps, values = columns_wrap(degrees, np.zeros((2, cols)), tell=False)
        assert (wraps, values.shape[1]) == expected, cols
    print("self-test passed")


def main():
    """Reads the arguments, compares, tells."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dem", nargs="?", help="any raster that GDAL reads")
    parser.add_argument("peaks", nargs="?", help="CSV of all peaks, from --min-prominence 0")
    parser.add_argument("--band", type=int, default=1)
    parser.add_argument("--nodata", type=float, help="in place of the file's")
    parser.add_argument("--vertical-unit", help="in place of the file's")
    parser.add_argument("--wrap", action=argparse.BooleanOptionalAction, help="in place of what the georeference says")
    parser.add_argument("--self-test", action="store_true", help="check this program itself")
    args = parser.parse_args()
    try:
        import gudhi  # noqa: F401
    except ImportError:
        fail("the Python package gudhi is not installed: pip install gudhi")
    if args.self_test:
        self_test()
        return
    if not args.peaks:
        parser.error("a DEM and a CSV of its peaks are needed")
    with tempfile.TemporaryDirectory() as workdir:
        heights, wraps, metres = read_dem(args.dem, args, workdir)
    found, rows = read_peaks(args.peaks)
    voids = int(np.isneginf(heights).sum())
    print(f"{heights.shape[0]} x {heights.shape[1]} cells, {voids} voids, {'wrapping, ' if wraps else ''}{rows} peaks")
    expected = metres(gudhi_pairs(heights, wraps))
    sys.exit(0 if verdict(multiset(expected), multiset(found)) else 1)


if __name__ == "__main__":
    main()
