from qgis.core import QgsApplication, QgsProcessingProvider

from .contour import Contour
from .interpolate import Interpolate
from .uncertainty import Uncertainty


class Provider(QgsProcessingProvider):
    """The algorithms csrbf:interpolate, csrbf:contour and csrbf:uncertainty."""

    def id(self):
        return "csrbf"

    def name(self):
        return "csrbf"

    def longName(self):
        return "csrbf: smooth functions from scattered data"

    def loadAlgorithms(self):
        for algorithm in (Interpolate, Contour, Uncertainty):
            self.addAlgorithm(algorithm())


class Plugin:
    """Adds the provider while the plugin is loaded."""

    def __init__(self):
        self.provider = None

    def initProcessing(self):
        self.provider = Provider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self):
        self.initProcessing()

    def unload(self):
        QgsApplication.processingRegistry().removeProvider(self.provider)
