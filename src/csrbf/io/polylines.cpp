#include "csrbf/io/polylines.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/atomic_file.hpp"
#include "csrbf/io/ply.hpp"
#include "csrbf/io/read_file.hpp"
#include "csrbf/io/text.hpp"

namespace csrbf {

bool is_polylines_file(const std::string& path) {
  return file_extension(path) == ".ply";
}

void write_polylines(const std::string& path, const Polylines& lines) {
  if (!is_polylines_file(path))
    throw IoError(path + ": unknown extension " + in_quotes(file_extension(path)) + "; files of curves are .ply");
  const bool valid =
      lines.edges.size() == 0 || (lines.edges.minCoeff() >= 0 && lines.edges.maxCoeff() < lines.vertices.cols());
  require(valid, "write_polylines", "vertex index", "out of range", "indices must be in [0, number of vertices)");
  write_file(path, format_ply(lines));
}

}  // namespace csrbf
