#include "csrbf/io/models/winding_archive.hpp"

#include <utility>

namespace csrbf {

Archive to_archive(const WindingNumber& winding) {
  Archive archive;
  archive.kind = "winding number";
  const WindingNumber::Data data = winding.data();
  archive.set("points", data.points);
  archive.set("normals", data.normals);
  archive.set("areas", data.areas);
  archive.set("smoothing_length", data.eps);
  return archive;
}

WindingNumber winding_from(const Archive& archive) {
  WindingNumber::Data data;
  data.points = archive.numbers("points", 3);
  data.normals = archive.numbers("normals", 3, data.points.cols());
  data.areas = archive.numbers("areas", data.points.cols(), 1);
  data.eps = archive.numbers("smoothing_length", data.points.cols(), 1);
  return WindingNumber(std::move(data));
}

}  // namespace csrbf
