#include "csrbf/io/models/tile_store.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/models/function_archive.hpp"

namespace csrbf {
namespace {

constexpr std::int64_t kept_bytes = std::int64_t{1} << 30;    // of tiles in memory, as they are in the file
constexpr std::size_t copied_at_once = std::size_t{4} << 20;  // bytes

}  // namespace

template <int Dim>
TileStore<Dim>::TileStore(std::string path, std::vector<std::int64_t> begin)
    : path_(std::move(path)), begin_(std::move(begin)) {
  require(begin_.size() > 1, "TileStore", "tiles", begin_.size(), "there must be one at least");
}

template <int Dim>
std::shared_ptr<const typename TileStore<Dim>::Tile> TileStore<Dim>::tile(Index number) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.number == number; });
  if (found != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, found);
    return found->tile;
  }
  kept_.push_front({number, read(number)});
  std::int64_t bytes = 0;
  for (auto it = kept_.begin(); it != kept_.end(); ++it) {
    bytes += begin_[it->number + 1] - begin_[it->number];
    if (bytes <= kept_bytes || it == kept_.begin()) continue;
    kept_.erase(it, kept_.end());
    break;
  }
  return kept_.front().tile;
}

template <int Dim>
std::shared_ptr<const typename TileStore<Dim>::Tile> TileStore<Dim>::read(Index number) const {
  const std::string name = path_ + ": tile " + std::to_string(number);
  std::string bytes(static_cast<std::size_t>(begin_[number + 1] - begin_[number]), '\0');
  const OpenFile file(open_file(path_, "rb"));
  if (file == nullptr) throw IoError(path_ + ": cannot be read any more");
  if (!seek_file(file.get(), begin_[number], SEEK_SET) ||
      std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
    throw IoError(name + ": the file is truncated");
  const Function function = function_from(parse_archive(bytes, name)).function;
  const Fit<Dim>& fit = function.fit<Dim>();
  return std::make_shared<const Tile>(Tile{fit.components, fit.variances});
}

template <int Dim>
std::shared_ptr<const Field<Dim>> StoredField<Dim>::field() const {
  const auto tile = tiles_->tile(tile_);
  const auto& fields = part_.is_variance ? tile->variances : tile->components;
  if (part_.component >= std::ssize(fields))
    throw IoError("tile " + std::to_string(tile_) + " of the model lacks a component");
  return fields[static_cast<std::size_t>(part_.component)];
}

template <int Dim>
void StoredField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  field()->evaluate_block(x, out);
  if (factor_ == 1) return;
  const auto scale = [&](double* from, Index count) {
    if (from != nullptr) Eigen::Map<Eigen::VectorXd>(from, count) *= factor_;
  };
  scale(out.value, x.cols());
  scale(out.gradient, Dim * x.cols());
  scale(out.hessian, symmetric_size<Dim> * x.cols());
}

void write_tiled_model(const std::string& path, const NamedFunction& function, const std::vector<std::string>& tiles) {
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 1> sizes(std::ssize(tiles));
  for (Index t = 0; t < sizes.size(); ++t)
    sizes[t] = static_cast<std::int64_t>(std::filesystem::file_size(utf8_path(tiles[static_cast<std::size_t>(t)])));
  Archive archive = to_archive(function);
  archive.set(tile_sizes_entry, sizes);
  AtomicFile out(path);
  out.write(format_archive(archive));
  std::string piece(copied_at_once, '\0');
  for (const std::string& tile : tiles) {
    const OpenFile file(open_file(tile, "rb"));
    if (file == nullptr) throw IoError(tile + ": cannot be read");
    for (std::size_t n = 0; (n = std::fread(piece.data(), 1, piece.size(), file.get())) > 0;)
      out.write(std::string_view(piece).substr(0, n));
  }
  out.commit();
}

template <int Dim>
void set_plan(Archive& archive, const TilePlan<Dim>& plan) {
  const std::vector<TileCut>& cuts = plan.cuts();
  Eigen::Matrix<std::int32_t, 3, Eigen::Dynamic> sides(3, std::ssize(cuts));
  Eigen::VectorXd at(std::ssize(cuts));
  for (Index i = 0; i < at.size(); ++i) {
    sides.col(i) << cuts[i].axis, cuts[i].below, cuts[i].above;
    at[i] = cuts[i].at;
  }
  archive.set("cuts", sides);
  archive.set("cut_at", at);
  archive.set("blend", plan.blend());
}

template <int Dim>
TilePlan<Dim> plan_of(const Archive& archive) {
  const auto& sides = archive.array<std::int32_t>("cuts", 3);
  const auto& at = archive.numbers("cut_at", sides.cols(), 1);
  std::vector<TileCut> cuts;
  for (Index i = 0; i < sides.cols(); ++i) cuts.push_back({sides(0, i), sides(1, i), sides(2, i), at(i, 0)});
  return TilePlan<Dim>(std::move(cuts), archive.number("blend"));
}

#define CSRBF_INSTANTIATE(Dim)                                      \
  template class TileStore<Dim>;                                    \
  template class StoredField<Dim>;                                  \
  template void set_plan<Dim>(Archive&, const TilePlan<Dim>& plan); \
  template TilePlan<Dim> plan_of<Dim>(const Archive&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
