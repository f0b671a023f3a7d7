#include "csrbf/levelset/partition/partition.hpp"

#include "csrbf/levelset/partition/partition_starts.hpp"
#include "csrbf/levelset/partition/potts_contours.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr int most_rounds = 15;            // of statistics and contours; by hand: most end after 3 to 6
constexpr double least_gain = 0.5;         // nats: less is not worth a round or another model
constexpr std::size_t followed = 2;        // starts of each model that are followed to their end; by hand
constexpr std::size_t first_followed = 5;  // of constant means; by hand: 2 miss a disc in noise of twice the contrast
constexpr double changed_share = 1e-5;     // of the labels may change at convergence
constexpr double independent = 0.3;  // correlation of neighbours up to which deviations tell regions apart; by hand
constexpr double least_variation = 0.05;  // of the contrast: below, constants are as good; by hand
constexpr double least_ratio = 1.25;      // of deviations of their own: less comes from blurred borders; by hand
constexpr Index large = 1 << 21;          // voxels from which only constant means from few starts are tried

struct Candidate {
  double price = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> labels;
};

struct Contest {
  PartitionModel model;
  std::vector<Candidate> best;  // of its starts, by price
};

class Search {
 public:
  Search(PartitionPrice& price, const PartitionOptions& options)
      : price_(price), options_(options), few_(price.grid().voxels() > large) {
    const auto voxels = static_cast<std::size_t>(price.grid().voxels());
    costs_.assign(options.regions == 2 ? 1 : static_cast<std::size_t>(options.regions), std::vector<float>(voxels));
  }

  Partition run() {
    gather_models();
    for_partition_starts(price_, options_.regions, few_, [&](PartitionStart&& start) {
      report(options_.progress, "evolve", 0);
      const double of_labels = price_.label_price(start.labels, options_.regions);
      for (Contest& contest : contests_)
        if (suits(contest.model.shape, start)) enter(contest, start.labels, of_labels);
    });
    double done = 0;
    std::vector<std::vector<std::uint8_t>> simpler;  // of the quadratic means, for the smooth ones
    for (Contest& contest : contests_) {
      if (contest.model.shape == MeanShape::quadratic)
        for (const Candidate& each : contest.best) simpler.push_back(each.labels);
      if (contest.model.shape == MeanShape::smooth)
        for (const std::vector<std::uint8_t>& labels : simpler)
          enter(contest, labels, price_.label_price(labels, options_.regions));
      report(options_.progress, "evolve", done++ / static_cast<double>(contests_.size()));
      play(contest);
    }
    for (ModelPrice& each : result_.prices) each.nats -= best_;
    return std::move(result_);
  }

 private:
  // From the simplest to the richest: each has to be worth its parameters.
  void gather_models() {
    const auto wanted = [&](MeanShape shape) { return !options_.shape || *options_.shape == shape; };
    if (wanted(MeanShape::constant) || few_ || options_.regions > 2) contests_.push_back({{}, {}});
    if (few_ || options_.regions > 2) return;
    if (wanted(MeanShape::constant)) contests_.push_back({{MeanShape::constant, true}, {}});
    for (const MeanShape shape : {MeanShape::linear, MeanShape::quadratic, MeanShape::smooth})
      if (wanted(shape)) contests_.push_back({{shape}, {}});
    if (!wanted(MeanShape::objects)) return;
    for (const std::uint8_t label : {std::uint8_t{1}, std::uint8_t{0}})
      contests_.push_back({{MeanShape::objects, false, label}, {}});
  }

  // Means that follow the image closely go on from what simpler ones found.
  [[nodiscard]] bool suits(MeanShape shape, const PartitionStart& start) const {
    if (shape == MeanShape::constant) return !start.local;
    return (start.classes || start.local) && (shape != MeanShape::smooth || options_.shape);
  }

  // Keeps the starts of least price.
  void enter(Contest& contest, const std::vector<std::uint8_t>& labels, double of_labels) {
    const double price = of_labels + price_.fit_values(labels, contest.model, options_.regions);
    if (!std::isfinite(price)) return;
    std::vector<Candidate>& best = contest.best;
    for (const Candidate& other : best)
      if (std::abs(other.price - price) < least_gain) return;
    const auto place = std::find_if(best.begin(), best.end(), [&](const Candidate& c) { return price < c.price; });
    // Noise hides the best start until its contours are smooth: of the simplest model more are followed.
    const bool simplest = contest.model.shape == MeanShape::constant && !contest.model.own_deviations;
    const std::size_t most = few_ ? 1 : simplest ? first_followed : followed;
    if (place == best.end() && best.size() >= most) return;
    best.insert(place, {price, labels});
    if (best.size() > most) best.pop_back();
  }

  void play(Contest& contest) {
    if (!result_.labels.empty()) enter(contest, result_.labels, price_.label_price(result_.labels, options_.regions));
    if (contest.best.empty()) return;
    ModelPrice entry{contest.model, contest.best.front().price, false};
    const bool promising = !contest.model.own_deviations || is_credible(contest.model, contest.best.front().labels);
    if (entry.nats < best_ - least_gain && promising) {
      entry.searched = true;
      for (Candidate& start : contest.best) {
        const double first = start.price;
        std::vector<double> steps;
        bool converged = false;
        Candidate found = follow(std::move(start), contest.model, steps, converged);
        entry.nats = std::min(entry.nats, found.price);
        if (found.price >= best_ - least_gain || !is_credible(contest.model, found.labels)) continue;
        best_ = found.price;
        result_.labels = std::move(found.labels);
        result_.model = contest.model;
        result_.converged = converged;
        result_.energy = {first};
        result_.energy.insert(result_.energy.end(), steps.begin(), steps.end());
      }
    }
    result_.prices.push_back(entry);
  }

  // Deviations of its own make a region likely wherever it gathers structures that its mean does not explain, and means
  // that vary follow such structures. Only voxels that are independent, as the likelihood has it, say which of these
  // there are. Objects leave the structures of one to itself, and planes follow none. Means that hardly vary follow
  // blurred borders.
  bool is_credible(const PartitionModel& model, const std::vector<std::uint8_t>& labels) {
    const bool varies = model.shape != MeanShape::constant;
    if ((!varies && !model.own_deviations) || options_.shape) return true;
    price_.fit(labels, model, options_.regions);
    if (model.own_deviations && price_.deviation_ratio() < least_ratio) return false;
    if (varies && price_.variation(labels) < least_variation) return false;
    const bool few = model.shape == MeanShape::objects || model.shape == MeanShape::linear;
    return few || price_.correlation(labels) <= independent;
  }

  // Statistics and contours in turns while the price falls.
  Candidate follow(Candidate now, const PartitionModel& model, std::vector<double>& steps, bool& converged) {
    Candidate best = now;
    for (int round = 0; round < most_rounds; ++round) {
      ++result_.iterations;
      move_contours(now.labels, model);
      now.price = price_.fit(now.labels, model, options_.regions);
      std::size_t changed = 0;
      for (std::size_t i = 0; i < now.labels.size(); ++i) changed += now.labels[i] != best.labels[i] ? 1 : 0;
      const bool better = now.price < best.price - least_gain;
      if (now.price < best.price) {
        best = now;
        steps.push_back(now.price);
      }
      if (!better || static_cast<double>(changed) <= changed_share * static_cast<double>(now.labels.size())) {
        converged = true;
        break;
      }
    }
    return best;
  }

  void move_contours(std::vector<std::uint8_t>& labels, const PartitionModel& model) {
    price_.fit(labels, model, options_.regions);
    if (options_.regions == 2) {
      price_.force(costs_[0]);
      convex_contour(price_.grid().size, price_.weight(), costs_[0], labels);
      price_.drop_parts(costs_[0], labels);
      return;
    }
    for (int k = 0; k < options_.regions; ++k) price_.cost(k, costs_[static_cast<std::size_t>(k)]);
    potts_contours(price_.grid().size, price_.weight(), costs_, labels);
  }

  PartitionPrice& price_;
  const PartitionOptions& options_;
  bool few_;
  std::vector<Contest> contests_;
  std::vector<std::vector<float>> costs_;
  Partition result_;
  double best_ = std::numeric_limits<double>::infinity();
};

}  // namespace

Partition find_partition(PartitionPrice& price, const PartitionOptions& options) {
  return Search(price, options).run();
}

}  // namespace csrbf
