#include "csrbf/surface/composite/patches.hpp"

#include "csrbf/surface/composite/patch_kernel.hpp"

namespace csrbf {
namespace {

constexpr int lanes = PatchSums::lanes;
constexpr int width = 4;         // arrays are filled up to a multiple of this: their loops have no remainder
constexpr int leaf_patches = 2;  // patches in a leaf of the hierarchy at most; chosen by hand

constexpr int padded(int count) {
  return (count + width - 1) / width * width;
}

// Points as structure of arrays.
struct Block {
  int count = 0;
  alignas(64) double x[3][lanes];
};

// Everything the kernels need of one patch.
struct PatchView {
  const Patch* patch;
  const double* centers;
  const double* alpha;
  Index count;
};

// The points of a block inside a patch, packed: where they stand in the block, local coordinates q and weight variable
// s = 1 - d^2. Filled up to a multiple of `width` with points of weight zero.
struct Inside {
  int count = 0;
  int point[lanes];
  alignas(64) double q[3][lanes];
  alignas(64) double s[lanes];
};

CSRBF_ALWAYS_INLINE void locate(const Patch& p, const Block& block, Inside& inside) {
  const double* T = p.T.data();  // column major
  const double cx = p.center[0], cy = p.center[1], cz = p.center[2], k = p.flatness * p.flatness;
  alignas(64) double q[3][lanes], s[lanes];
  for (int l = 0; l < padded(block.count); ++l) {
    const double dx = block.x[0][l] - cx, dy = block.x[1][l] - cy, dz = block.x[2][l] - cz;
    const double a = T[0] * dx + T[3] * dy + T[6] * dz;
    const double b = T[1] * dx + T[4] * dy + T[7] * dz;
    const double c = T[2] * dx + T[5] * dy + T[8] * dz;
    q[0][l] = a;
    q[1][l] = b;
    q[2][l] = c;
    s[l] = 1 - a * a - b * b - k * c * c;
  }
  int count = 0;
  for (int l = 0; l < block.count; ++l) {
    inside.point[count] = l;
    count += s[l] > 0 ? 1 : 0;
  }
  inside.count = count;
  for (int i = 0; i < count; ++i) {
    const int l = inside.point[i];
    for (int c = 0; c < 3; ++c) inside.q[c][i] = q[c][l];
    inside.s[i] = s[l];
  }
  for (int i = count; i % width != 0; ++i) inside.q[0][i] = inside.q[1][i] = inside.q[2][i] = inside.s[i] = 0;
}

// Adds the radial functions of a patch at `width` points, whose sums stay in registers.
template <int terms>
CSRBF_ALWAYS_INLINE void add_radial(const PatchView& view, int first, const double (*q)[lanes],
                                    double (*__restrict f)[lanes]) {
  using Numbers = Lanes<double, width>;
  const Numbers x(q[0] + first), y(q[1] + first), z(q[2] + first);
  Numbers sum[terms];
  for (int t = 0; t < terms; ++t) sum[t] = Numbers(f[t] + first);
  for (Index j = 0; j < view.count; ++j) {
    const double* center = view.centers + 3 * j;
    const double alpha = view.alpha[j];
    const Numbers dx = x - center[0], dy = y - center[1], dz = z - center[2];
    const Numbers dx2 = dx * dx, dxy2 = dy * dy + dx2, d2 = dz * dz + dxy2;
    const patch_kernel::ValueAndSlope<Numbers> phi(d2);
    sum[0] += alpha * phi.value;
    if constexpr (terms >= 4) {
      const Numbers g = alpha * phi.slope;
      sum[1] += g * dx;
      sum[2] += g * dy;
      sum[3] += g * dz;
      if constexpr (terms == 10) {
        const Numbers h = alpha * patch_kernel::bend(d2), hx = h * dx, hy = h * dy, hz = h * dz;
        sum[4] += hx * dx + g;
        sum[5] += hx * dy;
        sum[6] += hx * dz;
        sum[7] += hy * dy + g;
        sum[8] += hy * dz;
        sum[9] += hz * dz + g;
      }
    }
  }
  for (int t = 0; t < terms; ++t) sum[t].store(f[t] + first);
}

// Value, gradient and Hessian (1, 4 or 10 terms) of the local model in local coordinates, in units of the patch radius.
template <int terms>
CSRBF_ALWAYS_INLINE void local_model(const PatchView& view, int n, const double (*q)[lanes],
                                     double (*__restrict f)[lanes]) {
  const double* b = view.patch->quadric.data();
  for (int l = 0; l < n; ++l) {
    const double x = q[0][l], y = q[1][l], z = q[2][l];
    f[0][l] =
        b[0] + x * (b[1] + b[4] * x + b[5] * y + b[6] * z) + y * (b[2] + b[7] * y + b[8] * z) + z * (b[3] + b[9] * z);
    if constexpr (terms >= 4) {
      f[1][l] = b[1] + 2 * b[4] * x + b[5] * y + b[6] * z;
      f[2][l] = b[2] + b[5] * x + 2 * b[7] * y + b[8] * z;
      f[3][l] = b[3] + b[6] * x + b[8] * y + 2 * b[9] * z;
    }
    if constexpr (terms == 10) {
      f[4][l] = 2 * b[4];
      f[5][l] = b[5];
      f[6][l] = b[6];
      f[7][l] = 2 * b[7];
      f[8][l] = b[8];
      f[9][l] = 2 * b[9];
    }
  }
  for (int first = 0; first < n; first += width) add_radial<terms>(view, first, q, f);
}

// Weight (1 - d^2)^4 and its derivatives in local coordinates.
template <int terms>
CSRBF_ALWAYS_INLINE void weight(const Patch& p, int n, const double (*q)[lanes], const double* s,
                                double (*__restrict w)[lanes]) {
  const double k = p.flatness * p.flatness;
  for (int l = 0; l < n; ++l) {
    const double t = s[l], x = q[0][l], y = q[1][l], z = k * q[2][l];
    w[0][l] = t * t * t * t;
    if constexpr (terms >= 4) {
      const double g = -8 * t * t * t;
      w[1][l] = g * x;
      w[2][l] = g * y;
      w[3][l] = g * z;
      if constexpr (terms == 10) {
        const double h = 48 * t * t;
        w[4][l] = g + h * x * x;
        w[5][l] = h * x * y;
        w[6][l] = h * x * z;
        w[7][l] = g + h * y * y;
        w[8][l] = h * y * z;
        w[9][l] = g * k + h * z * z;
      }
    }
  }
}

// The cube of the weight.
template <int terms>
CSRBF_ALWAYS_INLINE void sharpen(int n, double (*__restrict w)[lanes]) {
  for (int l = 0; l < n; ++l) {
    const double v = w[0][l], first = 3 * v * v;
    int term = 4;
    for (int c = 1; terms == 10 && c < 4; ++c)
      for (int d = c; d < 4; ++d, ++term) w[term][l] = first * w[term][l] + 6 * v * w[c][l] * w[d][l];
    for (int c = 1; terms >= 4 && c < 4; ++c) w[c][l] *= first;
    w[0][l] *= v * v;
  }
}

// Gradient and Hessian from local to world coordinates: T^T v and T^T H T.
template <int terms>
CSRBF_ALWAYS_INLINE void to_world(const Eigen::Matrix3d& M, int n, double (*__restrict f)[lanes]) {
  const double* T = M.data();
  for (int l = 0; terms >= 4 && l < n; ++l) {
    const double gx = f[1][l], gy = f[2][l], gz = f[3][l];
    for (int c = 0; c < 3; ++c) f[1 + c][l] = T[3 * c] * gx + T[3 * c + 1] * gy + T[3 * c + 2] * gz;
  }
  for (int l = 0; terms == 10 && l < n; ++l) {
    const double h[3][3] = {{f[4][l], f[5][l], f[6][l]}, {f[5][l], f[7][l], f[8][l]}, {f[6][l], f[8][l], f[9][l]}};
    double HT[3][3];
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < 3; ++c) HT[i][c] = h[i][0] * T[3 * c] + h[i][1] * T[3 * c + 1] + h[i][2] * T[3 * c + 2];
    int term = 4;
    for (int c = 0; c < 3; ++c)
      for (int d = c; d < 3; ++d, ++term)
        f[term][l] = T[3 * c] * HT[0][d] + T[3 * c + 1] * HT[1][d] + T[3 * c + 2] * HT[2][d];
  }
}

// w f and w f^2 with derivatives, from those of w and f.
template <int terms>
CSRBF_ALWAYS_INLINE void products(int n, const double (*w)[lanes], const double (*f)[lanes],
                                  double (*__restrict wf)[lanes], double (*__restrict wff)[lanes]) {
  for (int l = 0; l < n; ++l) {
    const double F = f[0][l], w0 = w[0][l];
    wf[0][l] = w0 * F;
    wff[0][l] = w0 * F * F;
    if constexpr (terms >= 4)
      for (int c = 1; c < 4; ++c) {
        wf[c][l] = w[c][l] * F + w0 * f[c][l];
        wff[c][l] = w[c][l] * F * F + 2 * w0 * F * f[c][l];
      }
    if constexpr (terms == 10) {
      int term = 4;
      for (int c = 1; c < 4; ++c)
        for (int d = c; d < 4; ++d, ++term) {
          const double cross = w[c][l] * f[d][l] + w[d][l] * f[c][l];
          wf[term][l] = w[term][l] * F + cross + w0 * f[term][l];
          wff[term][l] = w[term][l] * F * F + 2 * F * cross + 2 * w0 * (f[c][l] * f[d][l] + F * f[term][l]);
        }
    }
  }
}

// Joins another piece g to f: the smaller or the larger of both values, with its derivatives.
template <int terms>
CSRBF_ALWAYS_INLINE void join_piece(Join join, int n, const double (*__restrict g)[lanes],
                                    double (*__restrict f)[lanes]) {
  const double sign = join == Join::intersection ? 1 : -1;
  alignas(64) double take[lanes];
  for (int l = 0; l < n; ++l) take[l] = sign * g[0][l] < sign * f[0][l] ? 1 : 0;
  for (int t = 0; t < terms; ++t)
    for (int l = 0; l < n; ++l) f[t][l] = take[l] != 0 ? g[t][l] : f[t][l];
}

// Adds what a patch says about the points of a block; `pieces` of them.
template <int terms>
CSRBF_ALWAYS_INLINE void add_pieces(const PatchView* views, int pieces, const Block& block, PatchSums& sums) {
  const PatchView& view = views[0];
  Inside inside;
  locate(*view.patch, block, inside);
  if (inside.count == 0) return;
  const int n = padded(inside.count);
  alignas(64) double f[terms][lanes], w[terms][lanes], wf[terms][lanes], wff[terms][lanes];
  local_model<terms>(view, n, inside.q, f);
  for (int p = 1; p < pieces; ++p) {
    local_model<terms>(views[p], n, inside.q, w);
    join_piece<terms>(views[p].patch->join, n, w, f);
  }
  weight<terms>(*view.patch, n, inside.q, inside.s, w);
  if (sums.sharp) sharpen<terms>(n, w);
  to_world<terms>(view.patch->T, n, f);
  to_world<terms>(view.patch->T, n, w);
  products<terms>(n, w, f, wf, wff);
  const double radius = view.patch->radius;
  for (int t = 0; t < terms; ++t)
    for (int i = 0; i < inside.count; ++i) {
      const int point = inside.point[i];
      sums.W[t][point] += w[t][i];
      sums.S[t][point] += wf[t][i] * radius;
      sums.A[t][point] += wf[t][i];
      sums.Q[t][point] += wff[t][i];
    }
}

CSRBF_ALWAYS_INLINE void add_weights(const Patch& patch, const Block& block, double* W) {
  Inside inside;
  locate(patch, block, inside);
  for (int i = 0; i < inside.count; ++i) {
    const double square = inside.s[i] * inside.s[i];
    W[inside.point[i]] += square * square;
  }
}

// The last point is repeated in unused lanes.
Block block_of(const PointsRef<3>& x) {
  Block block;
  block.count = static_cast<int>(x.cols());
  for (int l = 0; l < padded(block.count); ++l)
    for (int c = 0; c < 3; ++c) block.x[c][l] = x(c, std::min<Index>(l, x.cols() - 1));
  return block;
}

// Whether the ball around a patch meets the box.
bool reaches(const Patch& p, const Box<3>& box) {
  const Point<3> nearest = p.center.cwiseMax(box.lo).cwiseMin(box.hi);
  return (nearest - p.center).squaredNorm() < p.radius * p.radius;
}

// Box of the ellipsoid of a patch: half-widths are the lengths of the rows of (T^-1 scaled by the semi-axes).
Box<3> support_box(const Patch& p) {
  Eigen::Matrix3d axes = p.T.transpose() * (p.radius * p.radius);  // columns: semi-axis directions times radius
  axes.col(2) /= p.flatness;
  const Point<3> half = axes.rowwise().norm();
  return {p.center - half, p.center + half};
}

}  // namespace

Patches::Patches(std::vector<Patch> patches, std::vector<Index> center_begin, std::vector<double> centers,
                 std::vector<double> alpha)
    : patches_(std::move(patches)),
      center_begin_(std::move(center_begin)),
      centers_(std::move(centers)),
      alpha_(std::move(alpha)) {
  size_ = std::count_if(patches_.begin(), patches_.end(), [](const Patch& p) { return p.join == Join::first; });
  build();
}

void Patches::reserve(Index patches, Index centers_per_patch) {
  patches_.reserve(patches);
  center_begin_.reserve(patches + 1);
  alpha_.reserve(patches * centers_per_patch);
  centers_.reserve(3 * patches * centers_per_patch);
}

void Patches::add(const Patch& patch, const PointsRef<3>& centers, const Eigen::Ref<const Eigen::VectorXd>& alpha) {
  if (patch.join == Join::first) ++size_;
  patches_.push_back(patch);
  centers_.insert(centers_.end(), centers.data(), centers.data() + centers.size());
  alpha_.insert(alpha_.end(), alpha.data(), alpha.data() + alpha.size());
  center_begin_.push_back(static_cast<Index>(alpha_.size()));
}

void Patches::build() {
  first_piece_.clear();
  std::vector<Box<3>> boxes;
  boxes.reserve(patches_.size());
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    if (patches_[i].join != Join::first && i > 0) continue;
    first_piece_.push_back(i);
    boxes.push_back(support_box(patches_[i]));
  }
  first_piece_.push_back(patches_.size());
  nodes_.clear();
  if (!patches_.empty()) build_node(boxes, 0, std::ssize(boxes));
}

Index Patches::build_node(const std::vector<Box<3>>& boxes, Index begin, Index end) {
  const auto index = nodes_.size();
  nodes_.push_back({Box<3>{}, begin, end, 0});
  Box<3> box;
  if (end - begin <= leaf_patches) {
    for (Index i = begin; i < end; ++i) box.add(boxes[i]);
  } else {
    const Index middle = begin + (end - begin) / 2;
    build_node(boxes, begin, middle);
    const Index right = build_node(boxes, middle, end);
    nodes_[index].right = right;
    box = nodes_[index + 1].box;
    box.add(nodes_[right].box);
  }
  nodes_[index].box = box;
  return static_cast<Index>(index);
}

// Calls visit(first, pieces) for the patches whose ball meets the box, with their first piece and how many there are,
// until it returns false.
template <class Visit>
void Patches::visit(const Box<3>& box, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<Index, 64> stack;
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Index index = stack[--depth];
    const Node& node = nodes_[index];
    if (!node.box.intersects(box)) continue;
    if (node.right != 0) {
      stack[depth++] = node.right;
      stack[depth++] = index + 1;
      continue;
    }
    for (Index i = node.begin; i < node.end; ++i)
      if (const std::size_t first = first_piece_[i];
          reaches(patches_[first], box) && !visit(first, first_piece_[i + 1] - first))
        return;
  }
}

void Patches::accumulate(const PointsRef<3>& x, Derivatives derivatives, PatchSums& sums) const {
  constexpr std::array<int, 3> number_of_terms = {1, 4, PatchSums::max_terms};
  const int terms = number_of_terms[static_cast<std::size_t>(derivatives)];
  sums.derivatives = derivatives;
  for (int t = 0; t < terms; ++t)
    for (int l = 0; l < lanes; ++l) sums.W[t][l] = sums.S[t][l] = sums.A[t][l] = sums.Q[t][l] = 0;
  if (x.cols() == 0) return;
  const Block block = block_of(x);
  std::vector<PatchView> views;
  const auto add = derivatives == Derivatives::none       ? simd<add_pieces<1>>
                   : derivatives == Derivatives::gradient ? simd<add_pieces<4>>
                                                          : simd<add_pieces<PatchSums::max_terms>>;
  visit(bounding_box<3>(x), [&](std::size_t head, std::size_t pieces) {
    views.clear();
    for (std::size_t p = head; p < head + pieces; ++p) {
      const Index first = center_begin_[p];
      views.push_back({&patches_[p], centers_.data() + 3 * first, alpha_.data() + first, center_begin_[p + 1] - first});
    }
    add(views.data(), static_cast<int>(pieces), block, sums);
    return true;
  });
}

void Patches::weights(const PointsRef<3>& x, double* W, double enough) const {
  std::fill_n(W, x.cols(), 0);
  if (x.cols() == 0) return;
  const Block block = block_of(x);
  visit(bounding_box<3>(x), [&](std::size_t first, std::size_t) {
    simd<add_weights>(patches_[first], block, W);
    return *std::min_element(W, W + x.cols()) < enough;
  });
}

}  // namespace csrbf
