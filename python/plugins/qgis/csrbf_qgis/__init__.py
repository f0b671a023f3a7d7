"""Processing provider of csrbf for QGIS."""


def classFactory(interface):  # the name that QGIS asks for
    from .plugin import Plugin

    return Plugin()
