#pragma once

#include "csrbf/approx/function.hpp"
#include "csrbf/core/field.hpp"
#include "csrbf/levelset/segment.hpp"

#include <memory>
#include <string>
#include <vector>

namespace csrbf {

/// Writes a surface to a .csrbf file, completely or not at all; read_model() restores the same values, bit for bit.
/// Throws InvalidInput for fields that cannot be written, IoError if the file cannot be written.
void write_model(const std::string& path, const Field<3>& field);

/// Reads the implicit surface in a .csrbf file; a function of three variables with one component counts as one. Throws
/// IoError for files that are missing, damaged, of another kind, or from a newer version.
std::shared_ptr<const Field<3>> read_model(const std::string& path);

/// The level sets of a segmentation as a function of two or three variables, for write_model(). Two regions: one
/// component, `level_set`, positive in region 1. More regions: one component each, `region0`, `region1`, ...; the
/// positive one gives the label. In 3D, a function with one component is also a surface, which read_model() can read.
NamedFunction to_function(const Segmentation<2>& segmentation);
NamedFunction to_function(const Segmentation<3>& segmentation);

/// Writes a fitted function and its report to a .csrbf file, completely or not at all; read_function() restores the
/// same values, bit for bit. Throws InvalidInput for fields that cannot be written and for a wrong number of names,
/// IoError if the file cannot be written.
void write_model(const std::string& path, const NamedFunction& function);

/// Reads a function written by write_model() or by fit_tiles(), whose tiles are read when they are evaluated. A surface
/// counts as a function of x, y and z with the value `field`, positive inside. Throws IoError as read_model().
NamedFunction read_function(const std::string& path);

}  // namespace csrbf
