#include "figure_6_21.hpp"

#include "csrbf/surface/medial/medial_axis.hpp"
#include "csrbf/surface/medial/slope_penalty.hpp"
#include "csrbf/surface/prepare/prepare.hpp"
#include "models.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace csrbf::thesis {

std::vector<double> conditions(const PointCloud& cloud, Index centers, const std::vector<double>& weights) {
  const PreparedCloud prepared = prepare(cloud, Normals::file);
  const MedialAxisFit fit = fit_medial_axis(prepared.cloud, *prepared.tree, {.centers = centers, .smoothing = 1e-3});
  const SlopeSystem system = slope_system(fit.field->data(), prepared.cloud.points, prepared.cloud.normals);
  const Eigen::MatrixXd BtB = Eigen::MatrixXd(Eigen::SparseMatrix<double>(system.B.transpose() * system.B));
  Eigen::MatrixXd DtD = Eigen::MatrixXd::Zero(centers, centers);
  for (const SlopeSystem::Rows& D : system.D) DtD += Eigen::MatrixXd(Eigen::SparseMatrix<double>(D.transpose() * D));
  std::vector<double> found;
  for (const double weight : weights) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(BtB + weight * DtD, Eigen::EigenvaluesOnly);
    found.push_back(eigen.eigenvalues().maxCoeff() / std::max(eigen.eigenvalues().minCoeff(), 1e-300));
  }
  return found;
}

Figure figure_6_21() {
  constexpr double noise = 0.005;
  Figure figure{.name = "figure-6.21",
                .title = "Figs. 6.21-6.23: regularisation of section 6.2",
                .text =
                    "The kitten (for the squirrel) with Gaussian noise of half a per cent of the diagonal, with 500 "
                    "and 1000 centres. `smoothing` is relative: the weight of the slopes over that which makes "
                    "both terms equally large. Condition numbers are those of (6.32) for the normalised functions "
                    "and absolute weights (epsilon / t)^2."};
  const std::optional<PointCloud> kitten = model("kitten");
  if (!kitten) return without_models(figure);
  const PointCloud noisy = shaken(*kitten, noise);
  figure.renders.push_back({"noisy samples", picture(noisy, {})});
  for (const Index centers : {500, 1000}) {
    std::vector<double> errors;
    for (const auto& [smoothing, name] : {std::pair<std::optional<double>, std::string>{0.0, "none"},
                                          {1.0, "1"},
                                          {std::nullopt, "chosen by cross-validation"}}) {
      const MeasuredSurface surface = with_budget(noisy, "medial-axis", centers, smoothing);
      errors.push_back(measure(surface.field, 0, kitten->points).rms_taubin);
      const MeshedSurface mesh = meshed(surface);
      figure.renders.push_back({std::to_string(centers) + " centres, smoothing " + name, picture(mesh.mesh, {})});
    }
    const std::string what = "rms distance of the true points, " + std::to_string(centers) + " centres, smoothing ";
    figure.claims.push_back({what + "none and 1", "pictures: smoother with 1",
                             number(errors[0], 2) + ", " + number(errors[1], 2) + " of the diagonal",
                             verdict(errors[1] < errors[0])});
    figure.claims.push_back(
        {what + "chosen by cross-validation", "-", number(errors[2], 2) + " of the diagonal", Verdict::not_comparable});
  }
  std::vector<double> weights;
  for (int e = -4; e <= 3; ++e) weights.push_back(std::pow(10.0, e));
  Table table{.name = "condition", .columns = {"weight"}};
  for (const double weight : weights) table.rows.push_back({weight});
  double before = 0, at_one = 0, worst = 0;
  for (const Index centers : {500, 750, 1000}) {
    const std::vector<double> found = conditions(noisy, centers, weights);
    table.columns.push_back(std::to_string(centers) + " centres");
    for (std::size_t i = 0; i < found.size(); ++i) table.rows[i].push_back(found[i]);
    before = std::max(before, found.front());
    at_one = std::max(at_one, found[4]);
    worst = std::max(worst, *std::max_element(found.begin() + 4, found.end()));
  }
  figure.claims.push_back(
      {"6.23: condition falls with the weight and is acceptable from 1 on", "120,000 falls to about 0",
       number(before, 2) + " at 1e-4, " + number(at_one, 2) + " at 1, at most " + number(worst, 2) + " beyond",
       verdict(at_one < before && worst < 1e4)});
  figure.tables = {std::move(table)};
  return figure;
}

}  // namespace csrbf::thesis
