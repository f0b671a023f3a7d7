from qgis.core import QgsProcessingException, QgsProcessingParameterRasterDestination

from .engine import Failure
from .raster import write_raster
from .samples import SampleAlgorithm


class Interpolate(SampleAlgorithm):
    """Values between points as a raster."""

    def name(self):
        return "interpolate"

    def displayName(self):
        return "Interpolate"

    def shortHelpString(self):
        return (
            "A smooth function through points, or near them where they have noise, as a raster. The method, the kernel "
            "and the amount of smoothing are chosen by cross-validation; the log says which, and the error to expect."
        )

    def initAlgorithm(self, configuration=None):
        super().initAlgorithm(configuration)
        self.addParameter(QgsProcessingParameterRasterDestination("OUTPUT", "Values"))
        self.addParameter(QgsProcessingParameterRasterDestination(
            "DEVIATION", "Standard deviations", optional=True, createByDefault=False))

    def processAlgorithm(self, parameters, context, feedback):
        fitted, source, x, y = self.fit(parameters, context, feedback)
        outputs = {"OUTPUT": self.parameterAsOutputLayer(parameters, "OUTPUT", context)}
        write_raster(outputs["OUTPUT"], x, y, fitted.values(x, y), source.sourceCrs())
        feedback.setProgress(80)
        deviation = self.parameterAsOutputLayer(parameters, "DEVIATION", context)
        if deviation:
            try:
                write_raster(deviation, x, y, fitted.deviations(x, y), source.sourceCrs())
            except Failure as error:
                raise QgsProcessingException(str(error)) from None
            outputs["DEVIATION"] = deviation
        return outputs
