#include "csrbf/tiles/folder/field_file.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/surface/winding/winding_cubes.hpp"

namespace csrbf {
namespace {

constexpr std::uint64_t field_magic = 0x3164'6c66'2d62'7263;  // "crb-fld1"

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
  Eigen::VectorXd numbers() {
    Eigen::VectorXd values(static_cast<Index>(count(sizeof(double))));
    take(values.data(), values.size());
    return values;
  }
  Points<3> points() {
    const std::size_t n = count(sizeof(double));
    if (n % 3 != 0) fail();
    Points<3> values(3, static_cast<Index>(n / 3));
    take(values.data(), values.size());
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

// The tree of a winding number; building it again would cost more.
winding::Tree read_tree(FieldReader& file) {
  winding::Tree tree;
  file.take(tree.origin.data(), 3);
  tree.unit = file.take<double>();
  tree.nodes = file.vector<winding::Node>();
  tree.points = file.points();
  for (auto& axis : tree.x) axis = file.vector<std::int32_t>();
  for (auto& axis : tree.strength) axis = file.vector<float>();
  tree.eps2 = file.vector<float>();
  const auto padded = static_cast<std::size_t>(tree.points.cols() + winding::lanes);
  for (int k = 0; k < 3 && !tree.nodes.empty(); ++k)
    if (tree.x[k].size() != padded || tree.strength[k].size() != padded || tree.eps2.size() != padded) file.fail();
  return tree;
}

}  // namespace

void write_field(const std::string& path, const CompositeField& field) {
  const CompositeField::Data& data = field.data();
  FieldWriter file(path);
  file.put(field_magic);
  for (const Point<3>& p : {data.origin, data.bounds.lo, data.bounds.hi}) file.put(p.data(), 3);
  for (const double x : {data.scale, data.winding_level, data.far_value, data.feature_size, data.noisy ? 1.0 : 0.0})
    file.put(x);
  file.put(static_cast<std::int64_t>(data.levels.size()));
  for (const Patches& level : data.levels) {
    file.put_array(level.patches());
    file.put_array(level.center_begin());
    file.put_array(level.center_coordinates());
    file.put_array(level.alpha());
  }
  const winding::Tree& tree = data.winding.tree();
  file.put(tree.origin.data(), 3);
  file.put(tree.unit);
  file.put_array(tree.nodes);
  file.put_array(tree.points);
  for (const auto& axis : tree.x) file.put_array(axis);
  for (const auto& axis : tree.strength) file.put_array(axis);
  file.put_array(tree.eps2);
  const winding::MadeCubes cubes = data.winding.made_cubes();
  file.put_array(cubes.children);
  file.put_array(cubes.near);
  file.put_array(cubes.far);
  file.commit();
}

std::shared_ptr<const CompositeField> read_field(const std::string& path) {
  FieldReader file(path);
  if (file.take<std::uint64_t>() != field_magic) file.fail();
  CompositeField::Data data;
  for (Point<3>* p : {&data.origin, &data.bounds.lo, &data.bounds.hi}) file.take(p->data(), 3);
  for (double* x : {&data.scale, &data.winding_level, &data.far_value, &data.feature_size}) *x = file.take<double>();
  data.noisy = file.take<double>() != 0;
  const auto levels = file.take<std::int64_t>();
  if (levels < 1 || levels > 64) file.fail();
  for (std::int64_t i = 0; i < levels; ++i) {
    std::vector<Patch> patches = file.vector<Patch>();
    std::vector<Index> begin = file.vector<Index>();
    std::vector<double> centers = file.vector<double>();
    std::vector<double> alpha = file.vector<double>();
    if (begin.size() != patches.size() + 1 || centers.size() != 3 * alpha.size()) file.fail();
    data.levels.emplace_back(std::move(patches), std::move(begin), std::move(centers), std::move(alpha));
  }
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
