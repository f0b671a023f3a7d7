"""Parameters that the algorithms have in common: samples, where to evaluate them, and options of the fit."""

import math

import numpy as np
from qgis.core import (
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingException,
    QgsProcessingParameterDistance,
    QgsProcessingParameterEnum,
    QgsProcessingParameterExtent,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterNumber,
)

from .engine import Canceled, Failure, Fitted

SMOOTHING = ["auto", "none"]
EXTRAPOLATION = ["auto", "constant", "linear", "trend", "nan"]
CELLS = 250  # along the longer side, when no cell size is given
MOST_CELLS = 10**8  # half a gigabyte of output


class SampleAlgorithm(QgsProcessingAlgorithm):
    """Base of the algorithms: reads the samples, fits them, and lays out the cells."""

    def group(self):
        return ""

    def groupId(self):
        return ""

    def createInstance(self):
        return type(self)()

    def initAlgorithm(self, configuration=None):
        self.addParameter(QgsProcessingParameterFeatureSource("INPUT", "Points", [QgsProcessing.TypeVectorPoint]))
        self.addParameter(QgsProcessingParameterField(
            "FIELD", "Field of the values (the height z of the points when there is none)", None, "INPUT",
            QgsProcessingParameterField.Numeric, optional=True))
        self.addParameter(QgsProcessingParameterExtent(
            "EXTENT", "Extent (that of the points when not given)", optional=True))
        self.addParameter(QgsProcessingParameterDistance(
            "CELL", "Cell size (a 250th of the longer side when 0)", 0.0, "INPUT", False, 0.0))
        self.addParameter(QgsProcessingParameterEnum(
            "SMOOTHING", "Smoothing", ["by cross-validation", "none: through all samples"], defaultValue=0))
        self.addParameter(QgsProcessingParameterEnum(
            "EXTRAPOLATION", "Outside the box of the samples",
            ["the trend or the value at its edge, as the samples tell", "the value at its edge",
             "value and slope at its edge", "the trend", "no value"], defaultValue=0))
        missing = QgsProcessingParameterNumber(
            "MISSING", "Value of samples that have none, such as -9999", QgsProcessingParameterNumber.Double,
            optional=True)
        self.addParameter(missing)

    def fit(self, parameters, context, feedback):
        """The fitted function, the source, and the coordinates of the centres of the cells: x rising, y falling."""
        source = self.parameterAsSource(parameters, "INPUT", context)
        if source is None:
            raise QgsProcessingException(self.invalidSourceError(parameters, "INPUT"))
        points, values = self.samples(parameters, source, context, feedback)
        crs = source.sourceCrs()
        if crs.isGeographic():
            feedback.pushWarning(
                "The coordinates are degrees, and a degree of longitude is shorter than one of latitude: reproject the "
                "layer to metres for distances that are true.")
        options = {
            "smoothing": SMOOTHING[self.parameterAsEnum(parameters, "SMOOTHING", context)],
            "extrapolation": EXTRAPOLATION[self.parameterAsEnum(parameters, "EXTRAPOLATION", context)],
        }
        if parameters.get("MISSING") is not None:
            options["missing"] = self.parameterAsDouble(parameters, "MISSING", context)
        try:
            fitted = Fitted(points, values, options, feedback)
        except Failure as error:
            raise QgsProcessingException(str(error)) from None
        except Canceled:
            raise QgsProcessingException("Cancelled.") from None
        self.tell(fitted.report, feedback)
        extent = self.parameterAsExtent(parameters, "EXTENT", context, crs)
        if extent.isNull() or extent.isEmpty():
            extent = source.sourceExtent()
        x, y = self.cells(extent, self.parameterAsDouble(parameters, "CELL", context))
        return fitted, source, x, y

    def samples(self, parameters, source, context, feedback):
        """Points (n, 2) and values (n,) of all features that have both."""
        field = self.parameterAsString(parameters, "FIELD", context)
        place = source.fields().lookupField(field) if field else -1
        points, values, left_out = [], [], 0
        for feature in source.getFeatures():
            if feedback.isCanceled():
                raise QgsProcessingException("Cancelled.")
            value = number_of(feature[place]) if place >= 0 else None
            for vertex in feature.geometry().vertices():
                height = vertex.z() if place < 0 else value
                if height is None or not math.isfinite(height):
                    left_out += 1
                    continue
                points.append((vertex.x(), vertex.y()))
                values.append(height)
        if left_out > 0:
            feedback.pushWarning(f"{left_out} points have no value and are left out.")
        if not points:
            why = "" if field else "; the points have no heights"
            raise QgsProcessingException(f"No point has a value: choose the field of the values{why}.")
        return np.array(points), np.array(values)

    def cells(self, extent, size):
        """Centres of cells that cover the extent, from its upper left corner."""
        longest = max(extent.width(), extent.height())
        if not longest > 0:
            raise QgsProcessingException("The points lie at one place; give an extent.")
        size = size if size > 0 else longest / CELLS
        columns, rows = (max(1, math.ceil(side / size - 1e-6)) for side in (extent.width(), extent.height()))
        if columns * rows > MOST_CELLS:
            raise QgsProcessingException(f"{columns} x {rows} cells are too many; give a larger cell size.")
        x = extent.xMinimum() + size * (np.arange(columns) + 0.5)
        y = extent.yMaximum() - size * (np.arange(rows) + 0.5)
        return x, y

    def tell(self, report, feedback):
        used = [f"{name} {report[name]}" for name in ("samples", "method", "kernel") if name in report]
        feedback.pushInfo(", ".join(used))
        error = report.get("cross_validation_rmse")
        if error is not None:
            feedback.pushInfo(f"Error of new samples by cross-validation: {error:.4g}")
        for warning in report.get("warnings", []):
            feedback.pushWarning(warning)


def number_of(value):
    """A number, or None for an empty field."""
    try:
        return float(value)
    except (TypeError, ValueError):
        return None
