#include "table_8_1.hpp"

#include "csrbf/linalg/sparse_cholesky.hpp"
#include "signals.hpp"

#include <algorithm>

namespace csrbf::thesis {
namespace {

template <int Dim>
struct Task {
  Phantom phantom;
  std::array<Index, Dim> nodes;
  std::vector<std::uint8_t> start;
  ForceUpdate force;
  SegmentOptions options = {};
};

// H as a sparse matrix; its factor where that is small.
template <int Dim>
void time_matrix(const Nodes<Dim>& nodes, double support, Timing& timing) {
  Eigen::SparseMatrix<double> H;
  timing.build = seconds([&] {
    const RadialBasis<Dim> basis(Kernel("wendland-c2", Dim), nodes.points, Eigen::VectorXd::Constant(1, support));
    H = basis.matrix(nodes.points);
  });
  timing.entries = static_cast<double>(H.nonZeros()) / static_cast<double>(H.rows());
  if constexpr (Dim == 2) {
    SparseCholesky solver({.method = SparseMethod::direct});
    timing.factor = seconds([&] { solver.factorize(H); });
  }
}

template <int Dim>
Timing time_task(const std::string& name, const PublishedTimes& published, const Task<Dim>& task) {
  const Grid& grid = task.phantom.image.grid;
  const Nodes<Dim> nodes = regular_nodes<Dim>(grid, task.nodes);
  Timing timing{.name = name,
                .voxels = static_cast<double>(grid.voxels()),
                .nodes = static_cast<double>(nodes.points.cols()),
                .published = published};
  CollocationResult<Dim> result;
  timing.total =
      seconds([&] { result = collocate<Dim>(grid, nodes, task.start.data(), task.force, published_options()); });
  timing.set_up = result.system_seconds;
  timing.euler = result.solve_seconds + result.evaluate_seconds;
  timing.parameters = result.force_seconds;
  timing.iterations = result.iterations;
  timing.dice = dice(result.labels, task.phantom.truth);
  time_matrix<Dim>(nodes, result.support, timing);
  Segmentation<Dim> ours;
  timing.segment = seconds([&] { ours = segment<Dim>(task.phantom.image, task.options); });
  timing.segment_dice = dice(ours.labels, task.phantom.truth);
  return timing;
}

}  // namespace

Timing time_shape() {
  Task<2> task{holed_shape(), {100, 100}, {}, {}};
  add_white_noise(task.phantom.image, 30, 1);
  task.start = ball_labels(task.phantom.image.grid, Point<3>(155, 215, 0), 40);
  task.force = chan_vese_force(task.phantom.image);
  return time_task<2>("Simulation 1", {0.63, 0.31, 14.23, 31.08, 45.31}, task);
}

Timing time_star() {
  Task<2> task{star(), {150, 150}, {}, {}};
  task.start = ball_labels(task.phantom.image.grid, Point<3>(222.5, 222.5, 0), 100);
  task.force = chan_vese_force(task.phantom.image);
  return time_task<2>("Simulation 2", {1.47, 1.18, 23.51, 52.71, 76.22}, task);
}

Timing time_speckle() {
  Task<2> task{speckled_wall(1), {10, 60}, {}, {}};
  task.start = ball_labels(task.phantom.image.grid, Point<3>(20, 84, 0), 9);
  task.force = generalized_gaussian_force(task.phantom.image, 3);
  task.options.energy = SegmentEnergy::generalized_gaussian;
  task.options.seed = task.start;
  return time_task<2>("U.S.", {0.03, 0.01, 2.26, 20.64, 22.90}, task);
}

Timing time_bone() {
  constexpr Index n = 100;
  Task<3> task{bone(n), {37, 37, 37}, {}, {}};
  add_white_noise(task.phantom.image, 20, 1);
  task.start = ball_labels(task.phantom.image.grid, Point<3>::Constant(49.5), 30);
  task.force = chan_vese_force(task.phantom.image);
  return time_task<3>("Calcaneous", {12.93, 23.14, 401.15, 7604.32, 8005.47}, task);
}

Figure table_8_1() {
  Figure figure{.name = "table-8.1",
                .title = "Tables 8.1, 8.2: times",
                .text =
                    "Images of the sizes of the thesis's (whose own are not at hand), the same numbers of nodes, "
                    "supports of 4 h, normalisation. The thesis's times are those of a Pentium IV of 3.6 GHz; ours "
                    "are wall-clock times of all threads of this machine. Steps of Euler include values at all "
                    "voxels. segment() is the same task by the variational method with its defaults."};
  const std::vector<Timing> all{time_shape(), time_star(), time_speckle(), time_bone()};
  Table table{
      .name = "times",
      .columns = {"voxels", "nodes", "entries / row", "build [s]", "Cholesky [s]", "set-up [s]", "steps", "Euler [s]",
                  "parameters [s]", "total [s]", "published total [s]", "Dice", "segment() [s]", "Dice of segment()"}};
  for (const Timing& t : all) {
    table.rows.push_back({t.voxels, t.nodes, t.entries, t.build, t.factor, t.set_up, static_cast<double>(t.iterations),
                          t.euler, t.parameters, t.total, t.published.total, t.dice, t.segment, t.segment_dice});
    table.labels.push_back(t.name);
    const PublishedTimes& p = t.published;
    figure.claims.push_back({t.name + ": build H | Cholesky [s]", number(p.build) + " | " + number(p.factor),
                             number(t.build, 2) + " | " + (t.factor > 0 ? number(t.factor, 2) : "not needed") + "; " +
                                 number(t.set_up, 2) + " without a factor, as used",
                             Verdict::not_comparable});
    figure.claims.push_back({t.name + ": steps of Euler | parameters | total [s]",
                             number(p.euler, 5) + " | " + number(p.parameters, 6) + " | " + number(p.total, 6),
                             number(t.euler, 2) + " | " + number(t.parameters, 2) + " | " + number(t.total, 2) +
                                 "; segment() " + number(t.segment, 2),
                             Verdict::not_comparable});
  }
  const bool most = std::all_of(all.begin(), all.end(), [](const Timing& t) { return t.parameters > t.euler; });
  figure.claims.push_back({"the parameters of the velocities take most of the time", "yes",
                           most ? "yes" : "no: the steps do", verdict(most)});
  figure.tables = {std::move(table)};
  return figure;
}

}  // namespace csrbf::thesis
