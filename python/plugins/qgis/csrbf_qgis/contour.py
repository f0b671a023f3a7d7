import math

import numpy as np
from osgeo import gdal, ogr
from qgis.core import (
    QgsFeature,
    QgsField,
    QgsFields,
    QgsGeometry,
    QgsProcessing,
    QgsProcessingException,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QVariant

from .raster import NO_DATA, memory_raster
from .samples import SampleAlgorithm

LEVELS = 10  # when no interval is given, about
MOST_LEVELS = 2000


class Contour(SampleAlgorithm):
    """Contour lines of values between points."""

    def name(self):
        return "contour"

    def displayName(self):
        return "Contour"

    def shortHelpString(self):
        return "Contour lines of the smooth function through, or near, points. Smaller cells make smoother lines."

    def initAlgorithm(self, configuration=None):
        super().initAlgorithm(configuration)
        self.addParameter(QgsProcessingParameterNumber(
            "INTERVAL", "Interval between contours (about ten when 0)", QgsProcessingParameterNumber.Double, 0.0,
            minValue=0.0))
        self.addParameter(QgsProcessingParameterFeatureSink("OUTPUT", "Contours", QgsProcessing.TypeVectorLine))

    def processAlgorithm(self, parameters, context, feedback):
        fitted, source, x, y = self.fit(parameters, context, feedback)
        values = fitted.values(x, y)
        finite = values[np.isfinite(values)]
        if finite.size == 0:
            raise QgsProcessingException("The function has no value in the extent.")
        interval = self.parameterAsDouble(parameters, "INTERVAL", context) or round_step(np.ptp(finite) / LEVELS)
        if np.ptp(finite) / interval > MOST_LEVELS:
            raise QgsProcessingException(f"An interval of {interval:g} makes more than {MOST_LEVELS} contours.")
        fields = QgsFields()
        fields.append(QgsField("value", QVariant.Double))
        sink, identifier = self.parameterAsSink(
            parameters, "OUTPUT", context, fields, QgsWkbTypes.LineString, source.sourceCrs())
        if sink is None:
            raise QgsProcessingException(self.invalidSinkError(parameters, "OUTPUT"))
        for line, value in contour_lines(memory_raster(x, y, values, source.sourceCrs()), interval):
            feature = QgsFeature(fields)
            feature.setGeometry(QgsGeometry.fromWkt(line))
            feature.setAttributes([value])
            sink.addFeature(feature)
        return {"OUTPUT": identifier}


def contour_lines(raster, interval):
    """(WKT, value) of the contours at multiples of the interval, by GDAL."""
    store = ogr.GetDriverByName("Memory").CreateDataSource("")  # the layer lives as long as this
    layer = store.CreateLayer("contours", None, ogr.wkbLineString)
    layer.CreateField(ogr.FieldDefn("value", ogr.OFTReal))
    gdal.ContourGenerate(raster.GetRasterBand(1), interval, 0, [], 1, NO_DATA, layer, -1, 0)
    for feature in layer:
        yield feature.geometry().ExportToWkt(), feature.GetField("value")


def round_step(step):
    """1, 2 or 5 times a power of ten, at least the step."""
    if not step > 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(step))
    return next(power * m for m in (1, 2, 5, 10) if power * m >= step * (1 - 1e-9))
