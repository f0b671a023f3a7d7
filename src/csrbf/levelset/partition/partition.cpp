#include "csrbf/levelset/partition/partition.hpp"

#include "csrbf/levelset/convex/potts_contours.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/image/edgeless_share.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"
#include "csrbf/levelset/partition/considered_models.hpp"
#include "csrbf/levelset/partition/partition_starts.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr int most_rounds = 15;            // of statistics and contours; by hand: most end after 3 to 6
constexpr double least_gain = 0.5;         // nats: less is not worth a round or another model
constexpr std::size_t followed = 2;        // starts of each model that are followed to their end; by hand
constexpr std::size_t first_followed = 3;  // of constant means; by hand: 2 miss a disc in noise of twice the contrast
constexpr int trial_rounds = 2;            // before models are compared; by hand: most of the gain comes in the first
constexpr double roughly = 3e-4;           // mean change of u per iteration at the end of a contour on trial; by hand
constexpr double hope = 3;                 // gains of the last round that are still to be expected; by hand
constexpr double changed_share = 1e-5;     // of the labels may change at convergence
// Of the squares that other means leave, at most; by hand: bumps and vignettes of light 0.05 to 0.6, quadratics in
// nuclei at least 0.8.
constexpr double light_leaves = 0.65;
constexpr double unresolved = 4;          // half levels; by hand
constexpr double least_variation = 0.05;  // of the contrast: below, constants are as good; by hand
constexpr double least_ratio = 1.25;      // of deviations of their own: less comes from blurred borders; by hand
// Of contours that are no edges, at most; by hand: nuclei have up to 0.02, contours that cut a region in two 0.2 and
// more.
constexpr double most_edgeless = 0.1;
// Of what is alike in neighbours that smooth means leave, at most; by hand: light leaves up to 0.19, most nuclei
// more than 0.22.
constexpr double alike_in_light = 0.2;
// Of what objects in smooth light save, what a second region does, at least; by hand: in light 0.023 and more, with
// blurred spots for light at most 0.007.
constexpr double objects_share = 0.012;
// Correlation of what a background leaves where labels are only started from, which is more than in the end; by hand.
constexpr double promising = 0.65;

struct Candidate {
  double price = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> labels;
  double gain = std::numeric_limits<double>::infinity();  // of its last round
  std::vector<double> steps = {};                         // prices downwards
  bool converged = false;
};

struct Contest {
  PartitionModel model;
  std::vector<Candidate> best;  // by price
  [[nodiscard]] bool is_followed() const { return !best.empty() && !best.front().steps.empty(); }
  [[nodiscard]] double price() const { return best.empty() ? Candidate().price : best.front().price; }
};

class Search {
 public:
  Search(PartitionPrice& price, const PartitionOptions& options)
      : price_(price), options_(options), few_(price.grid().voxels() > options.many) {
    const auto voxels = static_cast<std::size_t>(price.grid().voxels());
    costs_.assign(options.regions == 2 ? 1 : static_cast<std::size_t>(options.regions), std::vector<float>(voxels));
  }

  Partition run() {
    for (const PartitionModel& model : considered_models(price_, options_, few_)) contests_.push_back({model, {}});
    for_partition_starts(price_, options_.regions, few_, [&](PartitionStart&& start) {
      report(options_.progress, "evolve", 0);
      const LabelMeasures measures = price_.measure(start.labels, options_.regions);
      for (Contest& contest : contests_)
        if (suits(contest.model, start)) enter(contest, start.labels, measures);
    });
    if (!options_.start.empty()) {
      const std::vector<std::uint8_t> given(options_.start.begin(), options_.start.end());
      for (Contest& contest : contests_) enter(contest, given, price_.measure(given, options_.regions));
    }
    for (Contest& contest : contests_) {
      for (const Contest& other : contests_)
        if (goes_on_from(contest.model, other.model, other.is_followed()))
          for (const Candidate& each : other.best)
            enter(contest, each.labels, price_.measure(each.labels, options_.regions));
      report_progress();
      if (contest.model.shape == MeanShape::objects) start_from_deviations(contest);
      try_out(contest);
    }
    std::vector<Contest*> order;
    for (Contest& contest : contests_) order.push_back(&contest);
    std::stable_sort(order.begin(), order.end(),
                     [](const Contest* a, const Contest* b) { return a->price() < b->price(); });
    for (Contest* contest : order) {
      report_progress();
      finish(*contest);
    }
    for (const Contest& contest : contests_)
      if (!contest.best.empty())
        result_.prices.push_back(
            {contest.model, contest.price() - price_found_, contest.best.front().steps.size() > 1});
    if (options_.regions == 2) result_.gain = price_of_one_region() - price_found_;
    for (Contest& contest : contests_)
      if (!contest.best.empty() && contest.model != result_.model)
        result_.others.push_back({contest.model, std::move(contest.best.front().labels)});
    return std::move(result_);
  }

 private:
  // Shapes count where the result has some: of one region they take its background for a peak.
  double price_of_one_region() {
    double least = std::numeric_limits<double>::infinity();
    for (const MeanShape shape : {MeanShape::constant, MeanShape::linear, MeanShape::quadratic}) {
      least = std::min(least, price_.price_of_one_region({shape}));
      if (result_.model.own_shapes)
        least = std::min(least, price_.price_of_one_region({shape, shape == MeanShape::constant, true}));
    }
    if (is_background(result_.model) || result_.model.shape == MeanShape::smooth)
      least = std::min(least, price_.price_of_one_region(result_.model));
    return least;
  }

  // Where other means have found no objects that are cheaper at once.
  bool may_be_better(const Candidate& start, Contest& contest) {
    enter(contest, result_.labels, price_.measure(result_.labels));
    return !is_cheaper(contest.best.front(), contest.model) &&
           start.price - hope * hoped_gain(start, contest.model) < best_;
  }

  // A region that gathers objects of different means has a deviation of its own. Its contours are far from those of
  // objects: they count after a few rounds.
  void start_from_deviations(Contest& contest) {
    for (const Contest& other : contests_) {
      if (other.model != PartitionModel{MeanShape::constant, true} || !(other.price() < contests_[0].price())) continue;
      price_.fit(other.best.front().labels, other.model);
      if (price_.most_deviating() != contest.model.object_label) return;
      std::vector<std::uint8_t> labels = other.best.front().labels;
      Candidate start{price_.fit(labels, contest.model), std::move(labels)};
      if (!std::isfinite(start.price)) return;
      if (other.price() >= best_ && !may_be_better(start, contest)) return;
      follow(start, contest.model, trial_rounds);
      enter(contest, start.labels, price_.measure(start.labels));
    }
  }

  [[nodiscard]] bool suits(const PartitionModel& model, const PartitionStart& start) const {
    if (model.shape == MeanShape::constant) return start.classes || !start.local;
    if (model.own_shapes && !options_.model) return start.of_ranks;
    if (is_background(model)) return start.close && model.reach == closest_background;
    if (model.shape == MeanShape::smooth && !options_.shape && !options_.model) return start.local && !start.of_ranks;
    return start.classes || start.local;
  }

  static bool is_background(const PartitionModel& model) { return model.shape == MeanShape::background; }

  static bool is_simplest(const PartitionModel& model) {
    return model.shape == MeanShape::constant && !model.own_deviations;
  }

  void report_progress() {
    report(options_.progress, "evolve", done_ / (2 * static_cast<double>(contests_.size())));
    done_ += 1;
  }

  // Keeps the starts of least price.
  void enter(Contest& contest, const std::vector<std::uint8_t>& labels, const LabelMeasures& measures) {
    const double price = price_.fit(labels, measures, contest.model);
    if (!std::isfinite(price)) return;
    std::vector<Candidate>& best = contest.best;
    for (const Candidate& other : best)
      if (std::abs(other.price - price) < least_gain) return;
    const auto place = std::find_if(best.begin(), best.end(), [&](const Candidate& c) { return price < c.price; });
    // Noise hides the best start until its contours are smooth: of the simplest model more are followed.
    const bool many = is_simplest(contest.model) || contest.model.shape == MeanShape::objects;
    const std::size_t most = few_ ? 1 : many ? first_followed : followed;
    if (place == best.end() && best.size() >= most) return;
    best.insert(place, Candidate{price, labels});
    if (best.size() > most) best.pop_back();
  }

  // A few rounds from the most promising starts: models are far apart, and rounds gain less and less.
  void try_out(Contest& contest) {
    state_.at_rest = roughly;
    const bool is_open = !is_background(contest.model) || !contest.best.empty();
    if (!result_.labels.empty() && is_open)
      enter(contest, result_.labels, price_.measure(result_.labels, options_.regions));
    std::vector<Candidate>& best = contest.best;
    if (best.empty() || !is_promising(contest)) return;
    // Smooth means start from what stands out and from what simpler ones found, of which either may lead astray.
    const std::size_t tried = is_simplest(contest.model)                 ? first_followed
                              : contest.model.shape == MeanShape::smooth ? followed
                                                                         : 1;
    for (std::size_t i = 0; i < std::min(tried, best.size()); ++i) follow(best[i], contest.model, trial_rounds);
    sort(best);
    take(best.front(), contest.model);
  }

  // Follows what may still become the cheapest to the end.
  void finish(Contest& contest) {
    state_.at_rest = ContourState().at_rest;
    if (contest.best.empty() || !std::isfinite(contest.best.front().gain)) return;
    // What is not credible after a trial seldom is so later.
    if (!is_credible(contest.model, contest.best.front().labels)) return;
    // What another model has found by now is a start, too.
    if (!is_background(contest.model)) enter(contest, result_.labels, price_.measure(result_.labels, options_.regions));
    for (Candidate& each : contest.best) {
      if (contest.price() > best_ && contest.price() - hope * contest.best.front().gain >= best_ &&
          !is_cheaper(contest.best.front(), contest.model))
        break;
      each.converged = false;
      follow(each, contest.model, most_rounds);
      take(each, contest.model);
    }
    sort(contest.best);
  }

  static void sort(std::vector<Candidate>& best) {
    std::stable_sort(best.begin(), best.end(),
                     [](const Candidate& a, const Candidate& b) { return a.price < b.price; });
  }

  // A background follows blurred borders, too: objects are compared with it as a camera blurs them.
  bool is_cheaper(const Candidate& found, const PartitionModel& model) {
    if (model.shape != MeanShape::objects || !is_background(result_.model)) return found.price < best_ - least_gain;
    return fit_blurred(price_, found.labels, model).price <
           fit_blurred(price_, result_.labels, result_.model).price - least_gain;
  }

  // The result when it is cheaper and credible.
  void take(const Candidate& found, const PartitionModel& model) {
    const bool goes_on = model == result_.model && found.price <= price_found_;
    if (!goes_on && !is_cheaper(found, model)) return;
    if (!is_credible(model, found.labels)) return;
    // Objects that a blur makes cheaper than a background may be dearer without: what comes after has to beat both.
    const bool by_blur = model.shape == MeanShape::objects && is_background(result_.model);
    best_ = by_blur || goes_on ? std::min(best_, found.price) : found.price;
    price_found_ = found.price;
    result_.labels = found.labels;
    result_.model = model;
    result_.converged = found.converged;
    result_.energy = found.steps;
    if (model.shape <= MeanShape::linear) {
      plain_ = {model, found.labels};
      plain_structures_.reset();
    }
  }

  // Nats that labels may gain by contours, for the means and deviations that they have now: where neighbours agree, not
  // where a voxel of noise is alone.
  double hoped_gain(const Candidate& found, const PartitionModel& model) {
    std::vector<float>& force = costs_[0];
    price_.fit(found.labels, model);
    price_.force(force);
    const Grid& grid = price_.grid();
    box_mean(force, grid.size, {1, 1, grid.dimension() == 3 ? 1 : 0});
    double sum = 0;
    for (std::size_t i = 0; i < force.size(); ++i)
      sum += static_cast<double>(std::max(found.labels[i] != 0 ? force[i] : -force[i], 0.0F));
    return sum;
  }

  bool is_promising(const Contest& contest) {
    const PartitionModel& model = contest.model;
    const Candidate& first = contest.best.front();
    // Objects that other means did not find are worth more than this price: means follow once they are in.
    const bool may_be = model.shape == MeanShape::objects && first.price - hoped_gain(first, model) < best_;
    if (!is_cheaper(first, model) && !(may_be && is_credible(model, first.labels))) return false;
    if (is_background(model) && !options_.shape && !options_.model) return leaves_noise(model, first.labels, promising);
    return (!model.own_deviations && !model.own_shapes) || is_credible(model, first.labels);
  }

  // Deviations of its own make a region likely wherever it gathers structures that its mean does not explain, and means
  // that vary follow such structures. Only voxels that are independent, as the likelihood has it, say which of these
  // there are. Shapes of their own have to be cheaper for the labels found than what a blur does to Gaussians. Objects
  // leave the structures of one to itself; planes follow none, but blurred borders. Means that hardly vary follow
  // these, too. Objects have edges: where there are three levels, a contour that cuts a region would give it two means.
  bool is_credible(const PartitionModel& model, const std::vector<std::uint8_t>& labels) {
    const bool varies = model.shape != MeanShape::constant;
    if ((!varies && !model.own_deviations) || options_.shape || options_.model) return true;
    const double price = price_.fit(labels, model, options_.regions);
    if (!std::isfinite(price)) return false;
    if (model.own_shapes && price > std::min(fit_blurred(price_, labels, {model.shape}).price,
                                             fit_blurred(price_, labels, {model.shape, true}).price) -
                                        least_gain)
      return false;
    // What intensities hardly resolve has the tails of their rounding.
    if (model.own_shapes && varies &&
        squares_left(model, labels) < std::pow(unresolved * price_.least_deviation(), 2) * price_.voxels())
      return false;
    if (model.own_shapes) price_.fit(labels, model);
    if (model.own_deviations && !model.own_shapes && price_.deviation_ratio() < least_ratio) return false;
    if (varies && price_.variation(labels) < least_variation) return false;
    if (model.shape == MeanShape::objects &&
        edgeless_share(price_.values(), labels, price_.grid(), price_.mask()) > most_edgeless)
      return false;
    if (is_background(model)) return leaves_noise(model, labels, independent) && tells_more_than_blur(model, labels);
    if (!model.own_shapes && model.shape == MeanShape::objects) return true;
    const bool in_light = !result_.labels.empty() && result_.model.shape != MeanShape::constant;
    if (model == PartitionModel{MeanShape::linear})
      return in_light || options_.regions > 2 || tells_more_than_blur(model, labels);
    const bool is_independent = price_.correlation(labels) <= independent;
    if (model.shape == MeanShape::smooth)
      return tells_objects_from_light(model, labels) &&
             (is_independent || (explains_structures(model, labels) && leaves_noise(model, labels, promising))) &&
             (model == result_.model || tells_more_than_blur(model, labels));
    if (is_independent) return true;
    if (model != PartitionModel{MeanShape::quadratic} || !in_light) return false;
    // Light that varies explains most of what is left of it, structures within regions do not.
    return model == result_.model ||
           squares_left(model, labels) <= light_leaves * squares_left(result_.model, result_.labels);
  }

  // A background follows whatever varies slowly: little but noise may be left of regions and their blurred borders,
  // correlated by no more than `most`.
  bool leaves_noise(const PartitionModel& model, const std::vector<std::uint8_t>& labels, double most) {
    constexpr double sharp = 0.8;  // where borders are sharp; by hand: most nuclei leave more, and are done with
    price_.fit(labels, model);
    return price_.correlation(labels) <= sharp &&
           residual_correlation(fit_blurred(price_, labels, model).residual, price_.grid()) <= most;
  }

  // What is alike in neighbours far from contours is light if smooth means explain most of it: structures within
  // regions stay.
  bool explains_structures(const PartitionModel& model, const std::vector<std::uint8_t>& labels) {
    if (plain_.labels.empty()) return false;
    if (!plain_structures_) plain_structures_ = structures_left(price_, plain_.labels, plain_.model);
    return structures_left(price_, labels, model) <= alike_in_light * *plain_structures_;
  }

  // Smooth means over less than usual follow blurred objects, too: then one region of them says nearly as much as two.
  bool tells_objects_from_light(const PartitionModel& model, const std::vector<std::uint8_t>& labels) {
    if (model.reach >= smooth_reach) return true;
    const double two = price_.fit(labels, model), all = price_.price_of_one_region({}) - two;
    return price_.price_of_one_region(model) - two > objects_share * all;
  }

  // For blurred borders alone no background and no light is needed.
  bool tells_more_than_blur(const PartitionModel& model, const std::vector<std::uint8_t>& labels) {
    return result_.labels.empty() || is_background(result_.model) ||
           fit_blurred(price_, labels, model).price <
               fit_blurred(price_, result_.labels, result_.model).price - least_gain;
  }

  // By blurred means.
  double squares_left(const PartitionModel& model, const std::vector<std::uint8_t>& labels) {
    price_.fit(labels, model, options_.regions);
    const std::vector<float> rest =
        options_.regions == 2 ? fit_blurred(price_, labels, model).residual : price_.rest(labels);
    double sum = 0;
    for (const float each : rest) sum += static_cast<double>(each) * static_cast<double>(each);
    return sum;
  }

  // Statistics and contours in turns while the price falls.
  void follow(Candidate& best, const PartitionModel& model, int rounds) {
    if (best.steps.empty()) best.steps = {best.price};
    std::vector<std::uint8_t> labels = best.labels;
    for (int round = 0; round < rounds && !best.converged; ++round) {
      ++result_.iterations;
      move_contours(labels, model);
      const double price = price_.fit(labels, model, options_.regions);
      std::size_t changed = 0;
      for (std::size_t i = 0; i < labels.size(); ++i) changed += labels[i] != best.labels[i] ? 1 : 0;
      best.converged = price >= best.price - least_gain ||
                       static_cast<double>(changed) <= changed_share * static_cast<double>(labels.size());
      best.gain = std::max(0.0, best.price - price);
      if (price >= best.price) return;
      best.price = price;
      best.labels = labels;
      best.steps.push_back(price);
    }
  }

  void move_contours(std::vector<std::uint8_t>& labels, const PartitionModel& model) {
    price_.fit(labels, model, options_.regions);
    if (options_.regions == 2) {
      price_.force(costs_[0]);
      convex_contour(price_.grid().size, price_.weight(), costs_[0], labels, &state_);
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
  ContourState state_;
  Partition result_;
  ModelLabels plain_;  // the last result with constant means or planes
  std::optional<double> plain_structures_;
  double best_ = std::numeric_limits<double>::infinity(), done_ = 0;
  double price_found_ = best_;  // the result's
};

}  // namespace

Partition find_partition(PartitionPrice& price, const PartitionOptions& options) {
  return Search(price, options).run();
}

}  // namespace csrbf
