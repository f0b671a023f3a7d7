#include "figure_6_8.hpp"

#include "models.hpp"

#include <algorithm>

namespace csrbf::thesis {

std::vector<double> smoothing_errors(const PointCloud& clean, const PointCloud& noisy, Index centers,
                                     const std::vector<double>& weights) {
  const auto error = [&](std::optional<double> weight) {
    return measure(with_budget(noisy, "composite", centers, weight).field, 0, clean.points).rms_taubin;
  };
  std::vector<double> errors{error(std::nullopt)};
  for (const double weight : weights) errors.push_back(error(weight));
  return errors;
}

Figure figure_6_8() {
  constexpr double noise = 0.005;
  Figure figure{.name = "figure-6.8",
                .title = "Fig. 6.8: regularisation under noise",
                .text =
                    "The bunny with Gaussian noise of half a per cent of the diagonal, its vertices' true normals, "
                    "1000 centres, composite method: root mean square Taubin distance of the points without noise "
                    "to the surface, over the weight of the native-space penalty (of (6.10), relative)."};
  const std::optional<PointCloud> bunny = model("bunny");
  if (!bunny) return without_models(figure);
  std::vector<double> weights;
  for (int e = -8; e <= 4; ++e) weights.push_back(std::pow(10.0, e));
  const std::vector<double> errors = smoothing_errors(*bunny, shaken(*bunny, noise), 1000, weights);
  Table table{.name = "errors", .columns = {"weight", "rms Taubin"}};
  for (std::size_t i = 0; i < weights.size(); ++i) table.rows.push_back({weights[i], errors[i + 1]});
  const double best = *std::min_element(errors.begin() + 1, errors.end());
  const double ends = std::min(errors[1], errors.back()) / best;
  constexpr double no_difference = 1.03;
  figure.claims = {{"one best weight", "yes",
                    number(best) + " of the diagonal; " + number(errors[1]) + " and " + number(errors.back()) +
                        " at the ends" + (ends < no_difference ? ": no difference" : ""),
                    verdict(ends >= no_difference)},
                   {"cross-validation can find it", "suggested",
                    number(errors.front()) + " of the diagonal with the weight that it chooses",
                    verdict(errors.front() < 1.1 * best)}};
  figure.tables = {std::move(table), {"chosen", {"rms Taubin"}, {{errors.front()}}}};
  return figure;
}

}  // namespace csrbf::thesis
