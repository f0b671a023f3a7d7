#include "csrbf/tiles/folder/field_file.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/surface/winding/winding_cubes.hpp"

namespace csrbf {
namespace {

constexpr std::uint64_t field_magic = 0x3264'6c66'2d62'7263;  // "crb-fld2"
constexpr Index rounded_at_once = 1 << 14;                    // numbers

// A patch in single precision, but for its place: half the size.
struct RoundedPatch {
  double center[3];
  float radius, flatness;
  float T[9];
  float quadric[10];
  std::int32_t join;

  RoundedPatch() = default;
  explicit RoundedPatch(const Patch& patch)
      : radius(static_cast<float>(patch.radius)),
        flatness(static_cast<float>(patch.flatness)),
        join(static_cast<std::int32_t>(patch.join)) {
    std::copy_n(patch.center.data(), 3, center);
    std::transform(patch.T.data(), patch.T.data() + 9, T, [](double x) { return static_cast<float>(x); });
    std::transform(patch.quadric.data(), patch.quadric.data() + 10, quadric,
                   [](double x) { return static_cast<float>(x); });
  }
  [[nodiscard]] Patch patch() const {
    Patch patch;
    std::copy_n(center, 3, patch.center.data());
    patch.radius = radius;
    patch.flatness = flatness;
    std::copy_n(T, 9, patch.T.data());
    std::copy_n(quadric, 10, patch.quadric.data());
    patch.join = static_cast<Join>(join);
    return patch;
  }
};

class FieldWriter {
 public:
  explicit FieldWriter(const std::string& path) : file_(path) {}

  template <class T>
  void put(const T* values, Index n) {
    file_.write({reinterpret_cast<const char*>(values), sizeof(T) * static_cast<std::size_t>(n)});
  }
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    put(&value, 1);
  }
  // An array of anything that is copied byte by byte, behind its length.
  template <class Array>
  void put_array(const Array& array) {
    put(static_cast<std::int64_t>(array.size()));
    put(array.data(), static_cast<Index>(array.size()));
  }
  void put_rounded(const std::vector<double>& values) {
    put(static_cast<std::int64_t>(values.size()));
    std::vector<float> part;
    for (Index at = 0; at < std::ssize(values); at += rounded_at_once) {
      const Index end = std::min(at + rounded_at_once, std::ssize(values));
      part.assign(values.begin() + at, values.begin() + end);
      put(part.data(), std::ssize(part));
    }
  }
  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
};

class FieldReader {
 public:
  explicit FieldReader(const std::string& path) : path_(path), file_(open_file(path, "rb")) {
    if (file_ == nullptr) throw IoError(path + ": cannot be read");
    left_ = std::filesystem::file_size(utf8_path(path));
  }

  template <class T>
  void take(T* values, Index n) {
    const std::size_t size = sizeof(T) * static_cast<std::size_t>(n);
    if (size > left_ || std::fread(static_cast<void*>(values), 1, size, file_.get()) != size) fail();
    left_ -= size;
  }
  template <class T>
  T take() {
    T value;
    take(&value, 1);
    return value;
  }
  template <class T>
  std::vector<T> vector() {
    std::vector<T> values(count(sizeof(T)));
    take(values.data(), std::ssize(values));
    return values;
  }
  std::vector<double> rounded() {
    std::vector<double> values(count(sizeof(float)));
    std::vector<float> part;
    for (Index at = 0; at < std::ssize(values); at += std::ssize(part)) {
      part.resize(std::min(rounded_at_once, std::ssize(values) - at));
      take(part.data(), std::ssize(part));
      std::copy(part.begin(), part.end(), values.begin() + at);
    }
    return values;
  }
  [[noreturn]] void fail() const { throw IoError(path_ + ": the file is damaged or incomplete"); }

 private:
  std::size_t count(std::size_t each) {
    const auto n = take<std::int64_t>();
    if (n < 0 || static_cast<std::size_t>(n) > left_ / each) fail();
    return static_cast<std::size_t>(n);
  }

  std::string path_;
  OpenFile file_;
  std::size_t left_ = 0;
};

void write_patches(FieldWriter& file, const Patches& level, FieldNumbers numbers) {
  if (numbers == FieldNumbers::exact) {
    file.put_array(level.patches());
    file.put_array(level.center_coordinates());
    file.put_array(level.alpha());
  } else {
    file.put(static_cast<std::int64_t>(level.pieces()));
    for (const Patch& patch : level.patches()) file.put(RoundedPatch(patch));
    file.put_rounded(level.center_coordinates());
    file.put_rounded(level.alpha());
  }
  file.put_array(level.center_begin());
}

Patches read_patches(FieldReader& file, FieldNumbers numbers) {
  std::vector<Patch> patches;
  std::vector<double> centers, alpha;
  if (numbers == FieldNumbers::exact) {
    patches = file.vector<Patch>();
    centers = file.vector<double>();
    alpha = file.vector<double>();
  } else {
    for (const RoundedPatch& patch : file.vector<RoundedPatch>()) patches.push_back(patch.patch());
    centers = file.rounded();
    alpha = file.rounded();
  }
  std::vector<Index> begin = file.vector<Index>();
  if (begin.size() != patches.size() + 1 || centers.size() != 3 * alpha.size()) file.fail();
  return {std::move(patches), std::move(begin), std::move(centers), std::move(alpha)};
}

// The tree of a winding number; building it again would cost more. Its values come from integers, which tell the points
// nearly.
void write_tree(FieldWriter& file, const winding::Tree& tree) {
  file.put(tree.origin.data(), 3);
  file.put(tree.unit);
  file.put_array(tree.nodes);
  for (const auto& axis : tree.x) file.put_array(axis);
  for (const auto& axis : tree.strength) file.put_array(axis);
  file.put_array(tree.eps2);
}

winding::Tree read_tree(FieldReader& file) {
  winding::Tree tree;
  file.take(tree.origin.data(), 3);
  tree.unit = file.take<double>();
  tree.nodes = file.vector<winding::Node>();
  for (auto& axis : tree.x) axis = file.vector<std::int32_t>();
  for (auto& axis : tree.strength) axis = file.vector<float>();
  tree.eps2 = file.vector<float>();
  if (tree.nodes.empty()) return tree;
  const std::size_t padded = tree.eps2.size();
  if (padded < winding::lanes) file.fail();
  for (int k = 0; k < 3; ++k)
    if (tree.x[k].size() != padded || tree.strength[k].size() != padded) file.fail();
  tree.points.resize(3, static_cast<Index>(padded) - winding::lanes);
  for (Index i = 0; i < tree.points.cols(); ++i)
    for (int k = 0; k < 3; ++k)
      tree.points(k, i) =
          tree.origin[k] + tree.unit / winding::Tree::resolution * tree.x[k][static_cast<std::size_t>(i)];
  return tree;
}

}  // namespace

void write_field(const std::string& path, const CompositeField& field, FieldNumbers numbers) {
  const CompositeField::Data& data = field.data();
  FieldWriter file(path);
  file.put(field_magic);
  file.put(numbers);
  for (const Point<3>& p : {data.origin, data.bounds.lo, data.bounds.hi}) file.put(p.data(), 3);
  for (const double x : {data.scale, data.winding_level, data.far_value, data.feature_size, data.noisy ? 1.0 : 0.0})
    file.put(x);
  file.put(static_cast<std::int64_t>(data.levels.size()));
  for (const Patches& level : data.levels) write_patches(file, level, numbers);
  write_tree(file, data.winding.tree());
  const winding::MadeCubes cubes = data.winding.made_cubes();
  file.put_array(cubes.children);
  file.put_array(cubes.near);
  file.put_array(cubes.far);
  file.commit();
}

std::shared_ptr<const CompositeField> read_field(const std::string& path) {
  FieldReader file(path);
  if (file.take<std::uint64_t>() != field_magic) file.fail();
  const auto numbers = file.take<FieldNumbers>();
  CompositeField::Data data;
  for (Point<3>* p : {&data.origin, &data.bounds.lo, &data.bounds.hi}) file.take(p->data(), 3);
  for (double* x : {&data.scale, &data.winding_level, &data.far_value, &data.feature_size}) *x = file.take<double>();
  data.noisy = file.take<double>() != 0;
  const auto levels = file.take<std::int64_t>();
  if (levels < 1 || levels > 64) file.fail();
  for (std::int64_t i = 0; i < levels; ++i) data.levels.push_back(read_patches(file, numbers));
  winding::Tree tree = read_tree(file);
  winding::MadeCubes cubes;
  cubes.children = file.vector<std::uint8_t>();
  cubes.near = file.vector<std::int32_t>();
  cubes.far = file.vector<float>();
  try {
    data.winding = WindingNumber(std::move(tree), cubes);
  } catch (const InvalidInput&) {
    file.fail();
  }
  return std::make_shared<const CompositeField>(std::move(data));
}

}  // namespace csrbf
