"""Rasters by the GDAL of QGIS."""

import os

import numpy as np
from osgeo import gdal
from qgis.core import QgsProcessingException, QgsRasterFileWriter

NO_DATA = -9999.0


def write_raster(path, x, y, values, crs):
    """Writes values [y, x] at the centres of cells as float32; NaN is no data."""
    driver_name = QgsRasterFileWriter.driverForExtension(os.path.splitext(path)[1]) or "GTiff"
    driver = gdal.GetDriverByName(driver_name)
    options = ["COMPRESS=DEFLATE", "PREDICTOR=3"] if driver_name == "GTiff" else []
    source = memory_raster(x, y, values, crs)
    # Formats that cannot be written piece by piece are copied.
    target = driver.CreateCopy(path, source, options=options) if driver else None
    if target is None:
        raise QgsProcessingException(f"{path} cannot be written: {gdal.GetLastErrorMsg()}")
    target.FlushCache()


def memory_raster(x, y, values, crs):
    """The raster in memory, x rising, y falling."""
    rows, columns = values.shape
    raster = gdal.GetDriverByName("MEM").Create("", columns, rows, 1, gdal.GDT_Float32)
    width = x[1] - x[0] if columns > 1 else (y[0] - y[1] if rows > 1 else 1.0)
    height = y[0] - y[1] if rows > 1 else width
    raster.SetGeoTransform((x[0] - width / 2, width, 0, y[0] + height / 2, 0, -height))
    if crs.isValid():
        raster.SetProjection(crs.toWkt())
    band = raster.GetRasterBand(1)
    band.SetNoDataValue(NO_DATA)
    band.WriteArray(np.where(np.isfinite(values), values, NO_DATA).astype(np.float32))
    return raster
