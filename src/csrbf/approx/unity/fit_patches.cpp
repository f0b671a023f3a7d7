#include "csrbf/approx/unity/fit_patches.hpp"

#include "csrbf/approx/unity/local_fit.hpp"
#include "csrbf/core/parallel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace csrbf {
namespace {

// Cells hold about .72 of their leaf size, supports growth^Dim times that, and the ball of the samples is a little
// (1.25) larger than the support. A metric is that of the middle of a cell, so cells with one hold half as many samples
// to keep it close to all of them.
template <int Dim>
Index leaf_size(const LocalOptions& options) {
  const double share = 1.25 * std::pow(cover_growth<Dim>, Dim) * 0.72 * (options.anisotropy > 0 ? 2 : 1);
  return std::max<Index>(1, static_cast<Index>(static_cast<double>(options.samples) / share));
}

// Batches of cells to fit.
template <int Dim>
std::vector<Index> wanted_batches(const Cover<Dim>& cover, const Points<Dim>* places) {
  std::vector<Index> batches((cover.size() + batch_lanes - 1) / batch_lanes);
  std::iota(batches.begin(), batches.end(), Index{0});
  if (places == nullptr) return batches;
  std::vector<bool> wanted(batches.size(), false);
  for (const auto& x : places->colwise())
    for (const std::uint32_t support : cover.supports_over(cover.find(x))) wanted[support / batch_lanes] = true;
  std::erase_if(batches, [&](Index b) { return !wanted[b]; });
  return batches;
}

// All arrays of models [first, first + count): action(first value, number of values).
template <class Models, class Action>
void for_each_array(Models& models, Index first, Index count, const Action& action) {
  const auto part = [&](auto& values) {
    const Index each = static_cast<Index>(values.size()) / models.size();
    action(values.data() + each * first, each * count);
  };
  part(models.center);
  part(models.radius);
  for (auto* values : {&models.metric, &models.position, &models.alpha, &models.polynomial}) part(*values);
}

template <int Dim>
std::shared_ptr<const typename PartitionOfUnity<Dim>::Data> fit_cover(Cover<Dim> cells, const Samples<Dim>& samples,
                                                                      const LocalOptions& options,
                                                                      const Progress& progress,
                                                                      const Points<Dim>* places) {
  auto data = std::make_shared<typename PartitionOfUnity<Dim>::Data>(
      typename PartitionOfUnity<Dim>::Data{std::move(cells), {}});
  const Cover<Dim>& cover = data->cover;
  const Eigen::MatrixXd values = cover.in_order(samples.values);
  const Eigen::VectorXd weights = cover.in_order(samples.weights);
  data->models = LocalFitter<Dim>(cover, values, weights, options).models();
  data->models.resize(cover.size());
  const std::vector<Index> batches = wanted_batches(cover, places);
  const auto count = static_cast<Index>(batches.size());
  const Index slice = std::max<Index>(1, count / 16);
  for (Index done = 0; done < count; done += slice) {
    report(progress, "fit", static_cast<double>(done) / static_cast<double>(count));
    const auto compute = [&](Index begin, Index end) {
      LocalFitter<Dim> fitter(cover, values, weights, options);
      for (Index k = done + begin; k < done + end; ++k) {
        const Index first = batch_lanes * batches[k];
        std::array<Index, batch_lanes> batch;
        std::iota(batch.begin(), batch.end(), first);
        fitter.fit(batch.data(), static_cast<int>(std::min<Index>(batch_lanes, cover.size() - first)), data->models,
                   first);
      }
    };
    parallel_for(std::min(slice, count - done), 8, compute);
  }
  return data;
}

}  // namespace

template <int Dim>
std::shared_ptr<const typename PartitionOfUnity<Dim>::Data> fit_patches(const Samples<Dim>& samples,
                                                                        const LocalOptions& options,
                                                                        const Progress& progress,
                                                                        const Points<Dim>* places) {
  return fit_cover<Dim>({samples.points, leaf_size<Dim>(options), cover_growth<Dim>}, samples, options, progress,
                        places);
}

template <int Dim>
std::shared_ptr<const typename PartitionOfUnity<Dim>::Data> fit_patches(const Samples<Dim>& samples, Cover<Dim> sorted,
                                                                        const LocalOptions& options,
                                                                        const Progress& progress) {
  return fit_cover<Dim>({std::move(sorted), leaf_size<Dim>(options)}, samples, options, progress, nullptr);
}

#define CSRBF_INSTANTIATE(Dim)                                                                                  \
  template std::shared_ptr<const PartitionOfUnity<Dim>::Data> fit_patches<Dim>(                                 \
      const Samples<Dim>&, const LocalOptions&, const Progress&, const Points<Dim>*);                           \
  template std::shared_ptr<const PartitionOfUnity<Dim>::Data> fit_patches<Dim>(const Samples<Dim>&, Cover<Dim>, \
                                                                               const LocalOptions&, const Progress&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
