#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/core/field.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace csrbf {

/// A fit, as it can be asked.
template <int Dim>
struct FittedParts {
  std::vector<std::shared_ptr<const Field<Dim>>> components, variances;
};

/// Of samples left out, targets x components: what they are missed by, and the squares of that expected.
struct LeftOutErrors {
  Eigen::MatrixXd errors, variances;
  std::vector<Index> places;  ///< first targets of the places that the gaps are moved to
  [[nodiscard]] double mean_square(Index component) const { return errors.col(component).squaredNorm() / size(); }
  /// Factor of the variances with which 95 % of the errors are within their intervals at each place.
  [[nodiscard]] double growth(Index component) const;

 private:
  [[nodiscard]] double size() const { return static_cast<double>(errors.rows()); }
};

/// What some ways to fit are worth in gaps: the gaps are moved to where samples are, these are left out there, and all
/// ways are fitted to the others. `outside_gaps`: 0 in gaps, 1 where samples are, in the box of the samples. One result
/// for each of `fits`; no results where gaps cannot be moved so that enough samples are in them and left. A fit sees at
/// most 2000 samples; there are up to three times as many fits as ways.
template <int Dim>
std::vector<LeftOutErrors> left_out_gaps(const Samples<Dim>& samples, const Field<Dim>& outside_gaps,
                                         const std::vector<std::function<FittedParts<Dim>(const Samples<Dim>&)>>& fits);

}  // namespace csrbf
