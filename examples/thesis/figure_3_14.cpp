#include "figure_3_14.hpp"

#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/levels/fixed_budget.hpp"
#include "csrbf/approx/levels/level_sum.hpp"
#include "signals.hpp"

#include <algorithm>

namespace csrbf::thesis {

std::vector<BudgetErrors> budget_errors(const SampledSlice& sampled, const std::vector<double>& shares) {
  const Points<2> pixels = sampled.slice.pixels();
  std::vector<BudgetErrors> all;
  for (const double share : shares) {
    BudgetErrors one{.share = share};
    const auto centers = static_cast<Index>(std::llround(share * static_cast<double>(sampled.samples.size())));
    one.centers = static_cast<double>(centers);
    one.seconds = seconds([&] {
      one.reconstructed = fixed_budget<2>(sampled.samples, {.centers = centers}).fields[0]->evaluate(pixels).value;
    });
    one.errors = slice_errors(sampled, one.reconstructed);
    all.push_back(one);
  }
  return all;
}

Figure figure_3_14() {
  Figure figure{.name = "figure-3.14",
                .title = "Figs. 3.13-3.15: a slice of a head from 30 % of its pixels, with a budget of functions",
                .text =
                    "fixed_budget (Wendland C2, supports of 4 scales of the bounded Voronoi cells) on the middle "
                    "sagittal slice of ch2.nii.gz (Debian package mricron-data), 217 x 180 = 39,060 pixels, of "
                    "which 11,718 are samples. err (3.10) is over all pixels, err_P (3.11) over the samples; the "
                    "text of the thesis says 25 %, its numbers are 30 %. It prints no values of the errors, only "
                    "curves that cannot be read from its text."};
  const std::optional<Slice> slice = brain_slice();
  if (!slice) return without_brain(figure);
  const SampledSlice sampled = sample_slice(*slice, 0.3, 1);
  const auto all = budget_errors(sampled, {0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1});

  Table table{.name = "errors", .columns = {"budget / samples", "centers", "err", "err_P", "seconds"}};
  const auto add_picture = [&](const std::string& name, const Eigen::VectorXd& values) {
    figure.pictures.push_back({name, slice->width, slice->height, values});
  };
  add_picture("original", slice->values);
  Eigen::VectorXd known = Eigen::VectorXd::Zero(slice->values.size());
  known(sampled.ids) = sampled.samples.values.col(0);
  add_picture("samples", known);
  for (const BudgetErrors& b : all) {
    table.rows.push_back({b.share, b.centers, b.errors.all, b.errors.samples, b.seconds});
    if (b.share != 0.1 && b.share != 0.5 && b.share != 1) continue;
    const std::string budget = number(b.centers, 6) + " functions";
    add_picture(budget, b.reconstructed);
    add_picture("error with " + budget, (b.reconstructed - slice->values).cwiseAbs());
    figure.claims.push_back({"err, err_P with " + budget, "not printed",
                             number(b.errors.all) + ", " + number(b.errors.samples), Verdict::not_comparable});
  }
  const auto falls = [&](double SliceErrors::*error) {
    return std::is_sorted(all.rbegin(), all.rend(), [&](const BudgetErrors& a, const BudgetErrors& b) {
      return a.errors.*error < b.errors.*error;
    });
  };
  figure.claims.push_back({"err_P falls with the budget", "yes",
                           "from " + number(all.front().errors.samples) + " to " + number(all.back().errors.samples),
                           verdict(falls(&SliceErrors::samples))});
  figure.claims.push_back({"err falls with the budget", "yes",
                           "from " + number(all.front().errors.all) + " to " + number(all.back().errors.all),
                           verdict(falls(&SliceErrors::all))});
  Eigen::VectorXd automatic;
  const double time = seconds([&] {
    automatic = fit<2>(sampled.samples, {.scale_axes = false}).components[0]->evaluate(slice->pixels()).value;
  });
  const SliceErrors errors = slice_errors(sampled, automatic);
  figure.claims.push_back(
      {"default fit of the library", "-",
       "err " + number(errors.all) + ", err_P " + number(errors.samples) + " in " + number(time, 2) + " s",
       Verdict::not_comparable});
  figure.tables.push_back(table);
  return figure;
}

}  // namespace csrbf::thesis
