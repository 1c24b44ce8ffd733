#!/usr/bin/env python3
"""Open a GeoPackage of `orograph peaks` in QGIS, without a screen, and draw it over its DEM.

usage: tools/qgis_picture.py LAYERS.gpkg OUT.png [DEM]

Exits 1 when a layer is not valid, or did not get the style that the GeoPackage holds for it.
Needs QGIS with its Python bindings (Debian, Ubuntu: apt-get install qgis python3-qgis) and the system's python3.
"""

import gc
import os
import sys

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

try:
    from qgis.core import (
        QgsApplication,
        QgsExpressionContext,
        QgsExpressionContextUtils,
        QgsHillshadeRenderer,
        QgsMapRendererSequentialJob,
        QgsMapSettings,
        QgsRasterLayer,
        QgsVectorLayer,
    )
    from qgis.PyQt.QtCore import QSize
    from qgis.PyQt.QtGui import QColor
except ImportError:
    sys.exit("QGIS's Python bindings are missing; on Debian and Ubuntu: apt-get install qgis python3-qgis")

# From the bottom to the top of the map, with the renderer that each layer's own style asks for.
STYLED = [
    ("isolation", "singleSymbol"),
    ("divide_tree", "graduatedSymbol"),
    ("saddles", "singleSymbol"),
    ("peaks", "graduatedSymbol"),
]
WIDTH = 1600


def open_layers(path):
    """The layers of the GeoPackage, topmost first, and what is wrong with them."""
    layers, faults = [], []
    for name, renderer in reversed(STYLED):
        layer = QgsVectorLayer(f"{path}|layername={name}", name, "ogr")
        found = layer.renderer().type() if layer.isValid() else "none"
        print(f"{name}: valid {layer.isValid()}, {layer.featureCount()} features, {layer.crs().authid()}, {found}")
        if not layer.isValid():
            faults.append(f"{name} is not a valid layer")
            continue
        if found != renderer:
            faults.append(f"{name} is drawn as {found}, its style asks for {renderer}")
        if name == "peaks" and not layer.labelsEnabled() and layer.labeling() is None:
            faults.append("peaks has no labels")
        layers.append(layer)
    return layers, faults


def open_dem(path):
    """The DEM as a hillshade; degrees are turned into metres, about."""
    dem = QgsRasterLayer(path, "dem")
    if not dem.isValid():
        sys.exit(f"{path}: QGIS cannot open it as a raster")
    shade = QgsHillshadeRenderer(dem.dataProvider(), 1, 315, 45)
    shade.setMultiDirectional(True)
    if dem.crs().isGeographic():
        shade.setZFactor(1 / 111000)
    dem.setRenderer(shade)
    dem.setOpacity(0.65)
    return dem


def main(layers_path, out, dem_path=None):
    layers, faults = open_layers(layers_path)
    if dem_path:
        layers.append(open_dem(dem_path))
    if layers:
        extent = layers[-1].extent()
        settings = QgsMapSettings()
        settings.setLayers(layers)
        settings.setDestinationCrs(layers[-1].crs())
        settings.setExtent(extent)
        settings.setOutputSize(QSize(WIDTH, max(1, round(WIDTH * extent.height() / extent.width()))))
        settings.setBackgroundColor(QColor("white"))
        # Without this the styles do not know the map's scale, and no label is thinned out.
        context = QgsExpressionContext()
        context.appendScope(QgsExpressionContextUtils.globalScope())
        context.appendScope(QgsExpressionContextUtils.mapSettingsScope(settings))
        settings.setExpressionContext(context)
        job = QgsMapRendererSequentialJob(settings)
        job.start()
        job.waitForFinished()
        faults.extend(f"{error.layerID}: {error.message}" for error in job.errors())
        if not job.renderedImage().save(out, "PNG"):
            faults.append(f"{out} cannot be written")
        print(f"drawn at 1:{settings.scale():.0f}: {out}")
    for fault in faults:
        print(f"fault: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    QgsApplication.setPrefixPath("/usr", True)
    application = QgsApplication([], False)
    application.initQgis()
    # Layers must be gone before QGIS is: hence a function, and a collection.
    status = main(*sys.argv[1:])
    gc.collect()
    application.exitQgis()
    sys.exit(status)
