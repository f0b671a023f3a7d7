#include "csrbf/core/parallel.hpp"
#include "thesis/gallery.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>

namespace py = pybind11;

namespace csrbf::thesis {
namespace {

using Array = py::array_t<double>;

Array to_array(const Table& table) {
  Array array({table.rows.size(), table.columns.size()});
  double* to = array.mutable_data();
  for (const std::vector<double>& row : table.rows) to = std::copy(row.begin(), row.end(), to);
  return array;
}

py::array_t<std::uint8_t> to_array(const RgbImage& image) {
  return py::array_t<std::uint8_t>({image.height, image.width, 3}, image.pixels.data());
}

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::fails:
      return "fails";
    default:
      return "not comparable";
  }
}

py::dict to_dict(const Figure& figure) {
  using namespace py::literals;
  py::dict tables, pictures;
  py::list renders, claims;
  for (const Table& table : figure.tables)
    tables[table.name.c_str()] =
        py::dict("columns"_a = table.columns, "rows"_a = to_array(table), "labels"_a = table.labels);
  for (const Picture& picture : figure.pictures)
    pictures[picture.name.c_str()] = Array({picture.height, picture.width}, picture.values.data());
  for (const Render& render : figure.renders)
    renders.append(py::dict("caption"_a = render.caption, "image"_a = to_array(render.image)));
  for (const Claim& claim : figure.claims)
    claims.append(py::dict("what"_a = claim.what, "published"_a = claim.published, "ours"_a = claim.ours,
                           "verdict"_a = name_of(claim.verdict)));
  return py::dict("name"_a = figure.name, "title"_a = figure.title, "text"_a = figure.text, "tables"_a = tables,
                  "pictures"_a = pictures, "renders"_a = renders, "claims"_a = claims, "missing"_a = figure.missing);
}

py::dict compute_figure(const std::string& name, const std::string& ultrasound, const std::string& bone) {
  Figure figure;
  {
    const py::gil_scoped_release release;
    figure = compute(name, {ultrasound, bone});
  }
  return to_dict(figure);
}

}  // namespace
}  // namespace csrbf::thesis

// Separate from _csrbf, so that importing csrbf does not load the figures.
PYBIND11_MODULE(_figures, m) {
  m.def("names", &csrbf::thesis::names);
  m.def("compute", &csrbf::thesis::compute_figure);
  m.def("set_thread_count", &csrbf::set_thread_count);
}
