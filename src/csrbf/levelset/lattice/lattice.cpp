#include "csrbf/levelset/lattice/lattice.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/lanes.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/parallel_sum.hpp"

#include <numeric>

namespace csrbf {
namespace {

constexpr Index tap_slack = 64;   // floats that are summed at a time
constexpr Index most_groups = 8;  // of phases with sums of their own: enough for the threads, few enough for memory
constexpr Index chunk = 512;      // blocks of tap_slack numbers that are worth a thread
constexpr Index chunk_voxels = 1 << 14;  // voxels, or coefficients, that are worth a thread

Index floor_div(Index a, Index b) {
  return a / b - (a % b != 0 && a < 0 ? 1 : 0);
}

struct SumBlocks {
  // Four accumulators share each broadcast weight and hide the latency of their sums.
  template <int Bytes>
  CSRBF_ALWAYS_INLINE static void run(const Tap* taps, Index count, const float* in, Index n, float* out, bool add) {
    using Floats = Lanes<float, 16, Bytes>;
    constexpr Index width = Floats::size, block = 4 * width;
    static_assert(block == tap_slack);
    for (Index i = 0; i < n; i += block) {
      Floats a(0.0F), b(0.0F), c(0.0F), d(0.0F);
      if (add) {
        a = Floats(out + i);
        b = Floats(out + i + width);
        c = Floats(out + i + 2 * width);
        d = Floats(out + i + 3 * width);
      }
      for (Index t = 0; t < count; ++t) {
        const float* from = in + i + taps[t].offset;
        const float w = taps[t].weight;
        a += w * Floats(from);
        b += w * Floats(from + width);
        c += w * Floats(from + 2 * width);
        d += w * Floats(from + 3 * width);
      }
      a.store(out + i);
      b.store(out + i + width);
      c.store(out + i + 2 * width);
      d.store(out + i + 3 * width);
    }
  }
};

// out[i] = sum over taps of weight * in[i + offset], i < n; added to what out holds when `add`. Arrays must not
// overlap, and both must have tap_slack readable (out: writable) entries behind their last used one.
void sum_taps(std::span<const Tap> taps, const float* in, Index n, float* out, bool add) {
  simd_call<SumBlocks>(taps.data(), std::ssize(taps), in, n, out, add);
}

// The ratio of small numbers that comes closest to `wanted` >= 1; the first within the tolerance will do.
std::pair<Index, Index> small_ratio(double wanted) {
  constexpr double tolerance = 0.03;  // relative; by hand: smaller needs larger ratios, and so more phases
  std::pair<Index, Index> best{1, 1};
  double best_error = std::numeric_limits<double>::infinity();
  for (Index q = 1; q <= 8 && best_error > tolerance; ++q) {
    const Index p = std::max(q, static_cast<Index>(std::lround(wanted * static_cast<double>(q))));
    const double error = std::abs(static_cast<double>(p) / static_cast<double>(q) - wanted) / wanted;
    if (error < best_error) {
      best_error = error;
      best = {p, q};
    }
  }
  return best;
}

void check(const std::array<Index, 3>& size, const Point<3>& spacing, const LatticeOptions& options,
           const Kernel& kernel, int dim) {
  constexpr const char* here = "Lattice";
  for (int a = 0; a < 3; ++a) {
    const Index n = size[a];
    if (a < dim)
      require(n >= 2, here, "size", n, "the image must have at least 2 voxels along each axis");
    else
      require(n == 1, here, "size", n, "the image must have one voxel along the axes that it does not have");
    require(spacing[a] > 0 && std::isfinite(spacing[a]), here, "spacing", spacing[a], "must be positive");
  }
  require(options.center_spacing >= 1 && options.center_spacing <= 1e6, here, "center_spacing", options.center_spacing,
          "must be at least 1 (voxel)");
  require(options.support > 1 && options.support <= 16, here, "support", options.support,
          "must be above 1 and at most 16 (center spacings)");
  require(kernel.compact() && kernel.smoothness() >= 1, here, "kernel", kernel.name(),
          "must be compact and have a gradient: wendland-c2, wendland-c4, wendland-c6, ...");
}

}  // namespace

template <int Dim>
Lattice<Dim>::Lattice(const std::array<Index, 3>& size, const Point<3>& spacing, const LatticeOptions& options)
    : size_(size), spacing_(spacing), kernel_(options.kernel, Dim), buffers_(std::make_shared<BufferPool>()) {
  check(size, spacing, options, kernel_, Dim);
  const double step = options.center_spacing * spacing.head<Dim>().minCoeff();
  for (Index a = 0; a < 3; ++a) {
    Axis& axis = axes_[a];
    axis.voxels = size[a];
    axis.edge = spacing[a];
    if (a >= Dim) continue;
    std::tie(axis.p, axis.q) = small_ratio(std::max(1.0, step / axis.edge));
    const double distance = axis.ratio() * axis.edge;
    center_spacing_ = a == 0 ? distance : std::min(center_spacing_, distance);
  }
  for (Axis& axis : axes_) {
    constexpr double alike = 1.1;  // up to this ratio distances are equal but for rounding
    const double distance = axis.ratio() * axis.edge;
    axis.stretch = distance <= alike * center_spacing_ ? 1 : center_spacing_ / distance;
  }
  support_ = options.support * center_spacing_;
  Index phases = 1;
  std::array<Index, 3> reach{0, 0, 0};
  for (Index a = 0; a < Dim; ++a) {
    Axis& axis = axes_[a];
    const double radius = support_ / axis.step();
    axis.first = floor_div(static_cast<Index>(std::ceil(axis.position(0) - radius)), axis.q);
    reach[a] = floor_div(static_cast<Index>(std::floor(axis.position(axis.p - 1) + radius)), axis.q) - axis.first;
    axis.length = axis.count(0) + reach[a];
    phases *= axis.p;
    classes_ *= axis.q;
  }
  plane_ = axes_[0].length * axes_[1].length * axes_[2].length;
  plane_ = (plane_ + tap_slack - 1) / tap_slack * tap_slack;
  slack_ = reach[0] + axes_[0].length * (reach[1] + axes_[1].length * reach[2]) + tap_slack;

  phases_.resize(phases);
  std::size_t i = 0;
  for (Index z = 0; z < axes_[2].p; ++z)
    for (Index y = 0; y < axes_[1].p; ++y)
      for (Index x = 0; x < axes_[0].p; ++x, ++i) {
        phases_[i].at = {x, y, z};
        make_phase(phases_[i]);
      }
  normalise();
  steepest_ = find_steepest();
}

template <int Dim>
void Lattice<Dim>::make_phase(Phase& phase) const {
  phase.backward.resize(classes_);
  phase.backward_with_gradient.resize(classes_);
  std::array<Index, 3> lo{0, 0, 0}, hi{0, 0, 0}, k{};
  for (Index a = 0; a < Dim; ++a) {
    const double radius = support_ / axes_[a].step();
    lo[a] = static_cast<Index>(std::ceil(axes_[a].position(phase.at[a]) - radius));
    hi[a] = static_cast<Index>(std::floor(axes_[a].position(phase.at[a]) + radius));
  }
  for (k[2] = lo[2]; k[2] <= hi[2]; ++k[2])
    for (k[1] = lo[1]; k[1] <= hi[1]; ++k[1])
      for (k[0] = lo[0]; k[0] <= hi[0]; ++k[0]) add_tap(phase, k);
}

template <int Dim>
void Lattice<Dim>::add_tap(Phase& phase, const std::array<Index, 3>& k) const {
  Point<3> x = Point<3>::Zero();
  Index group = 0, offset = 0;
  for (Index a = 3; a-- > 0;) {
    const Axis& axis = axes_[a];
    const Index entry = floor_div(k[a], axis.q);
    if (a < Dim) x[a] = (axis.position(phase.at[a]) - static_cast<double>(k[a])) * axis.step();
    group = group * axis.q + (k[a] - entry * axis.q);
    offset = offset * axis.length + (entry - axis.first);
  }
  const double r = x.norm() / support_;
  if (r >= 1) return;
  const double g = kernel_.g(r) / (support_ * support_);
  for (std::size_t part = 0; part <= Dim; ++part) {
    const auto weight = static_cast<float>(part == 0 ? kernel_.value(r)
                                                     : g * x[static_cast<Index>(part) - 1] * axes_[part - 1].stretch);
    phase.forward[part].push_back({group * plane_ + offset, weight});
    const Tap back{static_cast<Index>(part) * part_size() + slack_ - offset, weight};
    if (part == 0) phase.backward[group].push_back(back);
    phase.backward_with_gradient[group].push_back(back);
  }
}

template <int Dim>
void Lattice<Dim>::normalise() {
  double largest = 0;
  for (const Phase& phase : phases_)
    largest = std::max(largest, std::accumulate(phase.forward[0].begin(), phase.forward[0].end(), 0.0,
                                                [](double sum, const Tap& tap) { return sum + tap.weight; }));
  scale_ = 1 / largest;
  const auto scale = [this](std::vector<Tap>& taps) {
    for (Tap& tap : taps) tap.weight = static_cast<float>(scale_ * tap.weight);
  };
  for (Phase& phase : phases_) {
    for (std::vector<Tap>& taps : phase.forward) scale(taps);
    for (std::vector<Tap>& taps : phase.backward) scale(taps);
    for (std::vector<Tap>& taps : phase.backward_with_gradient) scale(taps);
    for (const Tap& tap : phase.forward[0]) coefficient_weight_ += static_cast<double>(tap.weight * tap.weight);
  }
  coefficient_weight_ /= static_cast<double>(classes_);
}

// On the plane x = 0 between nodes at x < 0 and x > 0, half a step away, the derivative of all columns of nodes.
template <int Dim>
double Lattice<Dim>::find_steepest() const {
  double slope = 0;
  std::array<Index, 3> reach{0, 0, 0}, k{};
  for (Index a = 0; a < Dim; ++a) reach[a] = static_cast<Index>(std::ceil(support_ / axes_[a].step()));
  for (k[2] = -reach[2]; k[2] <= reach[2]; ++k[2])
    for (k[1] = -reach[1]; k[1] <= reach[1]; ++k[1])
      for (k[0] = 0; k[0] <= reach[0]; ++k[0]) {
        Point<3> x = Point<3>::Zero();
        for (Index a = 0; a < Dim; ++a) x[a] = (static_cast<double>(k[a]) + (a == 0 ? 0.5 : 0.0)) * axes_[a].step();
        const double r = x.norm() / support_;
        if (r < 1) slope += -2 * kernel_.g(r) * x[0] / (support_ * support_);
      }
  return scale_ * slope;
}

template <int Dim>
double Lattice<Dim>::sweep(const float* coefficients, bool gradients,
                           const std::function<double(const LatticeRow&)>& row, float* derivatives) const {
  const auto phases = std::ssize(phases_);
  const Index groups = phases < 4 ? 1 : std::min(phases, most_groups);
  const auto workspace_size = static_cast<std::size_t>((gradients ? Dim + 1 : 1) * part_size());
  std::vector<double> sums(groups, 0.0);
  std::vector<std::unique_ptr<BufferPool::Buffer>> parts(groups);
  const auto run = [&](Index group) {
    const auto workspace = buffers_->take(workspace_size);
    for (Index part = 0; part < (gradients ? Dim + 1 : 1); ++part) {  // around what sweep_phase fills
      float* values = workspace->data() + part * part_size();
      std::fill_n(values, slack_, 0.F);
      std::fill_n(values + slack_ + plane_, slack_, 0.F);
    }
    float* sum = nullptr;
    if (derivatives != nullptr) {
      parts[group] = buffers_->take(static_cast<std::size_t>(array_size()));
      sum = parts[group]->data();
      std::fill_n(sum, array_size(), 0.F);
    }
    for (Index i = group; i < phases; i += groups)
      sums[group] += sweep_phase(phases_[i], coefficients, gradients, row, workspace->data(), sum);
  };
  if (groups == 1) {
    run(0);  // its loops have threads
  } else {
    parallel_for(groups, 1, [&](Index begin, Index end) {
      for (Index group = begin; group < end; ++group) run(group);
    });
  }
  if (derivatives != nullptr)
    parallel_for(array_size(), chunk_voxels, [&](Index begin, Index end) {
      std::copy(parts[0]->data() + begin, parts[0]->data() + end, derivatives + begin);
      for (std::size_t group = 1; group < parts.size(); ++group)
        for (Index i = begin; i < end; ++i) derivatives[i] += parts[group]->data()[i];
    });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

template <int Dim>
double Lattice<Dim>::sweep_phase(const Phase& phase, const float* coefficients, bool gradients,
                                 const std::function<double(const LatticeRow&)>& row, float* workspace,
                                 float* derivatives) const {
  const Index components = gradients ? Dim + 1 : 1;
  const Index blocks = plane_ / tap_slack;
  parallel_for(blocks, chunk, [&](Index begin, Index end) {
    for (Index part = 0; part < components; ++part)
      sum_taps(phase.forward[part], coefficients + begin * tap_slack, (end - begin) * tap_slack,
               workspace + part * part_size() + slack_ + begin * tap_slack, false);
  });

  const Index ny = axes_[1].length, rows = ny * axes_[2].length;
  const Index grain = std::max<Index>(1, chunk_voxels / axes_[0].length);
  const double sum = parallel_sum(rows, grain, [&](Index begin, Index end) {
    double part = 0;
    for (Index i = begin; i < end; ++i) part += visit_row(phase, gradients, row, workspace, i % ny, i / ny);
    return part;
  });

  if (derivatives != nullptr) {
    for (Index part = 0; part < components; ++part)  // behind the last row
      std::fill(workspace + part * part_size() + slack_ + axes_[0].length * rows,
                workspace + part * part_size() + slack_ + plane_, 0.F);
    parallel_for(blocks, chunk, [&](Index begin, Index end) {
      for (std::size_t group = 0; group < static_cast<std::size_t>(classes_); ++group)
        sum_taps(gradients ? phase.backward_with_gradient[group] : phase.backward[group], workspace + begin * tap_slack,
                 (end - begin) * tap_slack, derivatives + static_cast<Index>(group) * plane_ + begin * tap_slack, true);
    });
  }
  return sum;
}

// Padding between the rows must not reach the derivatives: it becomes 0.
template <int Dim>
double Lattice<Dim>::visit_row(const Phase& phase, bool gradients, const std::function<double(const LatticeRow&)>& row,
                               float* workspace, Index y, Index z) const {
  const auto [px, py, pz] = phase.at;
  const Index length = axes_[0].length;
  const Index count = y < axes_[1].count(py) && z < axes_[2].count(pz) ? axes_[0].count(px) : 0;
  LatticeRow part{};
  for (Index component = 0; component < (gradients ? Dim + 1 : 1); ++component) {
    float* values = workspace + component * part_size() + slack_ + length * (y + axes_[1].length * z);
    std::fill(values + count, values + length, 0.F);
    if (component == 0)
      part.value = values;
    else
      part.gradient[component - 1] = values;
  }
  if (count == 0) return 0;
  part.first = {px, axes_[1].p * y + py, axes_[2].p * z + pz};
  part.voxel = part.first[0] + size_[0] * (part.first[1] + size_[1] * part.first[2]);
  part.stride = axes_[0].p;
  part.count = count;
  return row(part);
}

template <int Dim>
Index Lattice<Dim>::nodes() const {
  Index product = 1;
  for (int a = 0; a < Dim; ++a) product *= nodes(a);
  return product;
}

template <int Dim>
Point<3> Lattice<Dim>::stretch() const {
  return {axes_[0].stretch, axes_[1].stretch, axes_[2].stretch};
}

template <int Dim>
Point<Dim> Lattice<Dim>::first_node() const {
  Point<Dim> p;
  for (Index a = 0; a < Dim; ++a)
    p[a] = axes_[a].middle() + static_cast<double>(axes_[a].q * axes_[a].first) * axes_[a].ratio();
  return p;
}

template <int Dim>
Point<Dim> Lattice<Dim>::node_step() const {
  Point<Dim> p;
  for (Index a = 0; a < Dim; ++a) p[a] = axes_[a].ratio();
  return p;
}

template <int Dim>
Index Lattice<Dim>::coefficient(const std::array<Index, 3>& node) const {
  Index group = 0, entry = 0;
  for (Index a = 3; a-- > 0;) {
    group = group * axes_[a].q + node[a] % axes_[a].q;
    entry = entry * axes_[a].length + node[a] / axes_[a].q;
  }
  return group * plane_ + entry;
}

template class Lattice<2>;
template class Lattice<3>;

}  // namespace csrbf
