"""DEMs as arrays for the benches, and what codecs without a bound of their own are given."""

import json
import math
import os
import pathlib
import subprocess

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
PROGRAM = TARGET / "release" / "orograph"
TYPES = {"Byte": "u1", "UInt16": "u2", "Int16": "i2", "UInt32": "u4", "Int32": "i4", "Float32": "f4", "Float64": "f8"}


def run(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def read(path, folder):
    """The first band as an array, whether cells are voids, and its nodata value, if it has one."""
    band = json.loads(run("gdalinfo", "-json", path))
    width, height = band["size"]
    raw = folder / "raw"
    run("gdal_translate", "-q", "-b", "1", "-of", "ENVI", path, raw)
    cells = np.fromfile(raw, dtype=TYPES[band["bands"][0]["type"]]).reshape(height, width)
    nodata = band["bands"][0].get("noDataValue")
    nodata = math.nan if nodata == "NaN" else nodata
    voids = ~np.isfinite(cells) if cells.dtype.kind == "f" else np.zeros(cells.shape, bool)
    if nodata is not None and not math.isnan(nodata):
        voids |= cells == cells.dtype.type(nodata)
    return cells, voids, nodata


def plain_copy(dem, path):
    """The first band as a GeoTIFF that is not compressed. Scales and units of feet would change what an error in
    metres means, so they are taken away: stored values are compared."""
    run("gdal_translate", "-q", "-b", "1", "-co", "COMPRESS=NONE", dem, path)
    run("gdal_edit.py", "-unsetstats", "-scale", "1", "-offset", "0", "-units", "m", path)


def filled(cells, voids):
    """The cells with their lowest elevation where there is none: few codecs know voids."""
    return np.where(voids, cells[~voids].min(), cells).astype(cells.dtype) if voids.any() else cells


def quantised(cells, error):
    """Small whole numbers, no further from the cells than the error."""
    if cells.dtype.kind == "f":
        numbers = np.rint(cells.astype(np.float64) / (2 * error * (1 - 2e-5))).astype(np.int64)
    else:
        step = 2 * math.floor(error) + 1
        numbers = np.floor_divide(cells.astype(np.int64) + step // 2, step)
    numbers -= numbers.min()
    return numbers.astype(np.uint16) if numbers.max() < 65536 else numbers.astype(np.uint32)
