#include "csrbf/approx/selection/select_samples.hpp"

#include "csrbf/approx/fit_method.hpp"
#include "csrbf/approx/kriging/confirm_errors.hpp"
#include "csrbf/approx/samples/robust_weights.hpp"
#include "csrbf/core/error.hpp"

namespace csrbf {
namespace {

// Those that are not missing, where some may be.
std::vector<Index> present_rows(const Eigen::MatrixXd& values, const std::optional<double>& missing) {
  std::vector<Index> rows;
  if (!missing) return rows;
  for (Index i = 0; i < values.rows(); ++i)
    if ((values.row(i).array() != *missing).all()) rows.push_back(i);
  require(!rows.empty() || values.rows() == 0, "fit", "missing", *missing,
          "all samples have this value; there is none to fit");
  return rows;
}

}  // namespace

template <int Dim>
SelectedSamples<Dim> select_samples(const Samples<Dim>& given, const FitOptions& options) {
  SelectedSamples<Dim> selected;
  const std::vector<Index> rows = present_rows(given.values, options.missing);
  const Samples<Dim>* samples = &given;
  if (options.missing) {
    selected.missing = given.values.rows() - std::ssize(rows);
    if (selected.missing > 0 && given.points.cols() == given.values.rows()) {
      selected.samples = chosen_samples(given, rows);
      samples = &*selected.samples;
    }
  }
  const FitMethodInfo* method = find_fit_method(options.method);
  const bool has_bound = options.tolerance > 0 || (method != nullptr && method->keeps_duplicates);
  const bool interpolates = options.smoothing && *options.smoothing == 0;
  if (options.loss == "auto" && (has_bound || interpolates)) return selected;  // all samples are to be met
  RobustWeights robust = robust_weights(*samples, options.loss);
  confirm_errors(*samples, robust);
  const auto given_rows = [&](std::vector<Index>& found) {
    for (Index& row : found)
      if (selected.missing > 0) row = rows[static_cast<std::size_t>(row)];
    return std::move(found);
  };
  selected.suspects = given_rows(robust.suspects);
  if (robust.factors.size() == 0) return selected;
  if (!selected.samples) selected.samples = given;
  selected.samples->weights = selected.samples->all_weights().cwiseProduct(robust.factors);
  if (options.loss == "auto") selected.samples = without_zero_weights(*selected.samples);
  if (options.loss == "auto" && given.weights.size() == 0) selected.samples->weights.resize(0);
  selected.gross_errors = given_rows(robust.gross_errors);
  return selected;
}

#define CSRBF_INSTANTIATE(Dim) \
  template SelectedSamples<Dim> select_samples<Dim>(const Samples<Dim>&, const FitOptions&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
