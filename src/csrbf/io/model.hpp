#pragma once

#include "csrbf/approx/function.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/levelset/segment.hpp"

#include <memory>
#include <string>
#include <vector>

namespace csrbf {

/// Writes a surface to a .csrbf file, complete or not at all: read_model() restores the same values, bit for bit.
/// Throws InvalidInput for a kind of field that has no file form, IoError when the file cannot be written.
void write_model(const std::string& path, const Field<3>& field);

/// Reads the implicit surface of a .csrbf file; a function of three variables with one component counts as one. Throws
/// IoError for files that are missing, damaged, of another kind or from a newer version.
std::shared_ptr<const Field<3>> read_model(const std::string& path);

/// The level sets of a segmentation as a function of two or three variables, for write_model(): for two regions the
/// single component `level_set`, positive in region 1; for more, one per region, `region0`, `region1`, ..., of which at
/// every place one is positive: the label there. In 3D, those with one component are surfaces, which read_model() reads
/// too.
NamedFunction to_function(const Segmentation<2>& segmentation);
NamedFunction to_function(const Segmentation<3>& segmentation);

/// Writes a fitted function with its report to a .csrbf file, complete or not at all: read_function() gives the same
/// values, bit for bit. Throws InvalidInput for fields that have no file form and when the numbers of names do not
/// match, IoError when the file cannot be written.
void write_model(const std::string& path, const NamedFunction& function);

/// Reads a function written by write_model(), or by fit_tiles(), whose tiles are read when they are evaluated; a
/// surface counts as one of x, y and z with the value `field`, positive inside. Throws IoError as read_model().
NamedFunction read_function(const std::string& path);

}  // namespace csrbf
