#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/levelset/partition/partition_model.hpp"

#include <optional>

namespace csrbf {

/// The price of a model with the best labels found for it.
struct ModelPrice {
  PartitionModel model;
  double nats = 0;        ///< above the model chosen
  bool searched = false;  ///< false: of the best start only, which was not good enough to go on from
};

struct PartitionOptions {
  int regions = 2;
  std::optional<MeanShape> shape = {};       ///< default: chosen
  std::optional<PartitionModel> model = {};  ///< the only one to consider; default: all
  std::span<const std::uint8_t> start = {};  ///< labels to start from, too
  Progress progress = {};                    ///< stage "evolve"
  Index many = 1 << 21;  ///< voxels above which means are constant, from few starts, without a model
};

/// The best labels found for a model.
struct ModelLabels {
  PartitionModel model;
  std::vector<std::uint8_t> labels;
};

struct Partition {
  std::vector<std::uint8_t> labels;  ///< none where there are too few voxels for regions of three
  PartitionModel model;
  std::vector<ModelPrice> prices;  ///< of all models considered
  std::vector<double> energy;      ///< the price in nats: the best start of each model taken, then its steps downwards
  double gain = 0;                 ///< nats, over the shortest description as one region; of two regions
  int iterations = 0;
  bool converged = false;
  std::vector<ModelLabels> others = {};  ///< of the models not chosen
  bool in_blur = false;                  ///< the contour follows a blurred border, not the noise there
};

/// The labels and the model of least price among many starts (for_partition_starts()), each followed by statistics and
/// globally optimal contours in turns. No price is above that of any start. Models and starts
/// are compared after two rounds, and only what may still become the cheapest is followed to its end. Cost: about 30
/// measures of labels and 15 to 30 contours.
Partition find_partition(PartitionPrice& price, const PartitionOptions& options = {});

}  // namespace csrbf
