from qgis.core import QgsProcessingException, QgsProcessingParameterRasterDestination

from .engine import Failure
from .raster import write_raster
from .samples import SampleAlgorithm


class Uncertainty(SampleAlgorithm):
    """How sure values between points are, as a raster."""

    def name(self):
        return "uncertainty"

    def displayName(self):
        return "Uncertainty"

    def shortHelpString(self):
        return (
            "Standard deviations of the interpolated values: small near the points, larger in gaps. Two of them to "
            "either side contain the true value at about 95 of 100 places."
        )

    def initAlgorithm(self, configuration=None):
        super().initAlgorithm(configuration)
        self.addParameter(QgsProcessingParameterRasterDestination("OUTPUT", "Standard deviations"))

    def processAlgorithm(self, parameters, context, feedback):
        fitted, source, x, y = self.fit(parameters, context, feedback)
        output = self.parameterAsOutputLayer(parameters, "OUTPUT", context)
        try:
            write_raster(output, x, y, fitted.deviations(x, y), source.sourceCrs())
        except Failure as error:
            raise QgsProcessingException(str(error)) from None
        return {"OUTPUT": output}
