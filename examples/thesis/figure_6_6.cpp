#include "figure_6_6.hpp"

#include "csrbf/surface/composite/choose_options.hpp"
#include "csrbf/surface/composite/composite_field.hpp"
#include "csrbf/surface/medial/medial_axis.hpp"
#include "csrbf/surface/prepare/prepare.hpp"
#include "models.hpp"

namespace csrbf::thesis {
namespace {

// As reconstruct() fits with a budget, but with the given centres, and no coarser levels.
std::shared_ptr<const Field<3>> composite(const PreparedCloud& prepared, const std::vector<Index>& centers) {
  constexpr Index points_per_center = 2, most_centers = 64, most_points = 1600;
  constexpr double winding_smoothing = 0.7, far_spacings = 3;
  const OrientedPoints& cloud = prepared.cloud;
  const auto count = static_cast<Index>(centers.size());
  GivenOptions given;
  given.leaf_size = std::max<Index>(CompositeOptions::smallest_leaf, cloud.size() * points_per_center / count);
  CompositeOptions options = choose_options(cloud, *prepared.tree, given).options;
  options.centers = centers;
  options.centers_per_patch = most_centers;
  options.max_fit_points = most_points;
  CompositeFit fit = fit_composite(cloud, *prepared.tree, options);
  CompositeField::Data data;
  data.levels.push_back(std::move(fit.patches));
  const Eigen::VectorXd smoothing = winding_smoothing * fit.areas.cwiseSqrt();
  data.winding = WindingNumber(cloud.points, cloud.normals, fit.areas, smoothing);
  data.far_value = far_spacings * std::sqrt(fit.areas.mean());
  data.feature_size = std::sqrt(fit.areas.mean());
  data.bounds = bounding_box<3>(cloud.points);
  return std::make_shared<const CompositeField>(std::move(data));
}

std::vector<double> column(const std::vector<ChoiceErrors>& all, CenterChoice choice,
                           double (*value)(const ChoiceErrors&)) {
  std::vector<double> values;
  for (const ChoiceErrors& e : all)
    if (e.choice == choice) values.push_back(value(e));
  return values;
}

Table table(const std::string& name, const std::vector<ChoiceErrors>& all, double (*value)(const ChoiceErrors&)) {
  Table result{.name = name, .columns = {"centers"}};
  const auto budgets = column(all, CenterChoice::random, [](const ChoiceErrors& e) { return e.centers; });
  for (const double budget : budgets) result.rows.push_back({budget});
  for (const CenterChoice choice : all_choices) {
    result.columns.push_back(name_of(choice));
    const std::vector<double> values = column(all, choice, value);
    for (std::size_t i = 0; i < values.size(); ++i) result.rows[i].push_back(values[i]);
  }
  return result;
}

// Furthest points are the last column.
Claim against(const Table& t, CenterChoice other, const std::string& what) {
  const std::size_t at = 1 + static_cast<std::size_t>(other);
  double mean = 0;
  for (const auto& row : t.rows) mean += row.back() / row[at] / static_cast<double>(t.rows.size());
  const std::string ours = number(mean) + " times the error, mean of all budgets";
  const std::string name = what + ": furthest points against " + name_of(other);
  if (other == CenterChoice::k_means) return {name, "similar", ours, verdict(mean < 1.25 && mean > 0.8)};
  constexpr double no_difference = 0.03;
  if (std::abs(mean - 1) < no_difference) return {name, "smaller errors", ours + ": no difference", Verdict::fails};
  return {name, "smaller errors", ours, verdict(mean < 1)};
}

}  // namespace

std::vector<ChoiceErrors> choice_errors(const PointCloud& cloud, const std::vector<Index>& budgets) {
  const PreparedCloud prepared = prepare(cloud, Normals::file);
  const Points<3>& points = prepared.cloud.points;
  std::vector<ChoiceErrors> all;
  for (const Index budget : budgets)
    for (const CenterChoice choice : all_choices) {
      const std::vector<Index> centers = choose_centers(choice, points, budget);
      const auto count = static_cast<double>(budget);
      ChoiceErrors errors{choice, count};
      errors.composite = measure(composite(prepared, centers), count, points);
      errors.medial =
          measure(fit_medial_axis(prepared.cloud, *prepared.tree, {.center_indices = centers}).field, count, points);
      all.push_back(std::move(errors));
    }
  return all;
}

Figure figure_6_6() {
  Figure figure{.name = "figure-6.6",
                .title = "Figs. 6.6, 6.7: how the centres are chosen",
                .text =
                    "The bunny (35,947 vertices, data of Debian's libcgal-demo) with budgets of centres chosen in "
                    "four ways: at random, by PCA, by k-means, and as furthest points; of the means of PCA and k-means "
                    "the nearest samples, where the thesis takes the means of PCA themselves. |f| (6.16) and Taubin's "
                    "distance |f| / |grad f| (6.17) at the samples, in diagonals of the bounding box; the unit of "
                    "the thesis is not known, its curves are pictures."};
  const std::optional<PointCloud> bunny = model("bunny");
  if (!bunny) return without_models(figure);
  const auto all = choice_errors(*bunny, {500, 1000, 2000, 5000, 10000});
  using E = const ChoiceErrors&;
  figure.tables = {table("6.6 a: mean |f|, composite", all, [](E e) { return e.composite.mean_offset; }),
                   table("6.6 b: rms |f|, composite", all, [](E e) { return e.composite.rms_offset; }),
                   table("6.7 a: mean Taubin, composite", all, [](E e) { return e.composite.mean_taubin; }),
                   table("6.7 b: rms Taubin, composite", all, [](E e) { return e.composite.rms_taubin; }),
                   table("rms Taubin, medial axis", all, [](E e) { return e.medial.rms_taubin; })};
  for (const CenterChoice other : {CenterChoice::random, CenterChoice::pca, CenterChoice::k_means}) {
    figure.claims.push_back(against(figure.tables[3], other, "rms Taubin, composite"));
    figure.claims.push_back(against(figure.tables[4], other, "rms Taubin, medial axis"));
  }
  for (const auto& [t, what] : {std::pair{3, "composite"}, std::pair{4, "medial axis"}}) {
    const auto& rows = figure.tables[t].rows;
    figure.claims.push_back({std::string("rms Taubin, ") + what + ", 500 and 10,000 furthest points",
                             "starts at .016 (unit unknown)",
                             number(rows.front().back(), 2) + ", " + number(rows.back().back(), 2) + " of the diagonal",
                             verdict(rows.front().back() <= 4e-3 && rows.back().back() <= 3e-4)});
  }
  return figure;
}

}  // namespace csrbf::thesis
