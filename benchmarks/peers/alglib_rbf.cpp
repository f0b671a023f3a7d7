// The radial basis functions of ALGLIB, to compare csrbf with. This program, and it alone, is under the GPL of ALGLIB.
// usage: alglib_rbf SAMPLES.npy QUERIES.npy OUT.npy COST.json (hierarchical|spline) SMOOTHING

#include "cost.hpp"

#include "csrbf/io/samples.hpp"

#include <libalglib/interpolation.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>

using csrbf::Index;

namespace {

// As its manual advises: radii from a few times what spreads over the data down to less than the spacing.
void choose_hierarchical(const alglib::rbfmodel& model, const Eigen::MatrixXd& points, double smoothing) {
  const double extent = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  const double spacing =
      extent / std::pow(static_cast<double>(points.cols()), 1.0 / static_cast<double>(points.rows()));
  const double radius = extent / 4;
  const int layers = std::max(2, 2 + static_cast<int>(std::ceil(std::log2(radius / spacing))));
  alglib::rbfsetalgohierarchical(model, radius, layers, smoothing);
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 7) {
    std::cerr << "usage: alglib_rbf SAMPLES.npy QUERIES.npy OUT.npy COST.json (hierarchical|spline) SMOOTHING\n";
    return 2;
  }
  const csrbf::SampleTable samples = csrbf::read_samples(arguments[1]);
  const Index d = samples.coordinates.rows(), n = samples.coordinates.cols();
  const Eigen::MatrixXd queries = csrbf::read_queries(arguments[2], csrbf::default_coordinate_names(d)).coordinates;
  const double smoothing = std::stod(arguments[6]);

  const Cost cost;
  alglib::real_2d_array rows;
  rows.setlength(n, d + 1);
  for (Index i = 0; i < n; ++i) {
    for (Index a = 0; a < d; ++a) rows[i][a] = samples.coordinates(a, i);
    rows[i][d] = samples.values(i, 0);
  }
  alglib::rbfmodel model;
  alglib::rbfcreate(d, 1, model);
  alglib::rbfsetpoints(model, rows);
  if (std::string(arguments[5]) == "hierarchical")
    choose_hierarchical(model, samples.coordinates, smoothing);
  else
    alglib::rbfsetalgothinplatespline(model, smoothing);
  alglib::rbfreport report;
  alglib::rbfbuildmodel(model, report);
  if (report.terminationtype <= 0) {
    std::cerr << "alglib_rbf: no model, code " << report.terminationtype << '\n';
    return 1;
  }
  Eigen::MatrixXd values(queries.cols(), 1);
  alglib::real_1d_array x, y;
  x.setlength(d);
  for (Index i = 0; i < queries.cols(); ++i) {
    for (Index a = 0; a < d; ++a) x[a] = queries(a, i);
    alglib::rbfcalc(model, x, y);
    values(i, 0) = y[0];
  }
  cost.write(arguments[4]);
  csrbf::write_table(arguments[3], {samples.coordinate_names, {"value"}, queries, values});
  return 0;
} catch (const alglib::ap_error& error) {
  std::cerr << "alglib_rbf: " << error.msg << '\n';
  return 1;
} catch (const std::exception& error) {
  std::cerr << "alglib_rbf: " << error.what() << '\n';
  return 1;
}
