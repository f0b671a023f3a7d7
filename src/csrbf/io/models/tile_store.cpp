#include "csrbf/io/models/tile_store.hpp"

#include "csrbf/approx/function_fit.hpp"
#include "csrbf/approx/samples/fitted_field.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/models/surface_archive.hpp"

namespace csrbf {
namespace {

constexpr std::int64_t kept_bytes = std::int64_t{1} << 30;      // of tiles in memory, as they are in the file
constexpr std::int64_t most_components = 1024;                  // a limit on damaged files
constexpr std::int64_t copied_at_once = std::int64_t{4} << 20;  // bytes

template <int Dim>
std::vector<TilePlace> places_of([[maybe_unused]] const Field<Dim>& field) {
  if constexpr (Dim <= largest_dimension) {
    const auto* fitted = dynamic_cast<const FittedField<Dim>*>(&field);
    const auto* tiled = dynamic_cast<const TiledField<Dim>*>(fitted != nullptr ? &fitted->inner() : &field);
    if (tiled == nullptr) return {};
    const auto* stored = dynamic_cast<const StoredField<Dim>*>(tiled->tiles().front().inside.get());
    return stored != nullptr ? stored->tiles()->places() : std::vector<TilePlace>{};
  }
  return {};
}

}  // namespace

template <int Dim>
TileStore<Dim>::TileStore(std::vector<TilePlace> places) : places_(std::move(places)) {
  require(!places_.empty(), "TileStore", "tiles", places_.size(), "there must be one at least");
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
    bytes += places_[it->number].size;
    if (bytes <= kept_bytes || it == kept_.begin()) continue;
    kept_.erase(it, kept_.end());
    break;
  }
  return kept_.front().tile;
}

template <int Dim>
std::shared_ptr<const typename TileStore<Dim>::Tile> TileStore<Dim>::read(Index number) const {
  const TilePlace& place = places_[number];
  std::string bytes(static_cast<std::size_t>(place.size), '\0');
  const OpenFile file(open_file(place.path, "rb"));
  if (file == nullptr) throw IoError(place.path + ": cannot be read any more");
  if (!seek_file(file.get(), place.begin, SEEK_SET) ||
      std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
    throw IoError(place.path + ": the file is damaged: it ends in tile " + std::to_string(number));
  const std::string name = place.path + ": tile " + std::to_string(number);
  const Archive archive = parse_archive(bytes, name);
  if constexpr (Dim == 3)
    if (archive.kind != function_kind) return std::make_shared<const Tile>(Tile{{surface_from(archive)}, {}});
  const Function function = function_from(archive).function;
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

std::vector<TilePlace> tile_places(const Function& function) {
  return std::visit(
      [](const auto& fit) -> std::vector<TilePlace> {
        if constexpr (std::is_same_v<std::decay_t<decltype(fit)>, std::monostate>) {
          return {};
        } else {
          return places_of(*fit.components.front());
        }
      },
      function.any_fit());
}

std::vector<TilePlace> tile_places(const Field<3>& surface) {
  return places_of(surface);
}

void write_archive(const std::string& path, const Archive& archive, const std::vector<TilePlace>& tiles) {
  std::error_code ignored;
  if (archive.has(tile_sizes_entry) && tiles.empty())
    throw InvalidInput("write_model: field: parts of it are in tiles of another file, which cannot be copied into it");
  for (const TilePlace& tile : tiles)
    require(!std::filesystem::equivalent(utf8_path(path), utf8_path(tile.path), ignored), "write_model", "path", path,
            "the tiles of the model are read from this file; choose another name");
  AtomicFile out(path);
  out.write(format_archive(archive));
  std::string piece;
  for (const TilePlace& tile : tiles) {
    const OpenFile file(open_file(tile.path, "rb"));
    bool reads = file != nullptr && seek_file(file.get(), tile.begin, SEEK_SET);
    for (std::int64_t left = tile.size; left > 0 && reads; left -= std::ssize(piece)) {
      piece.resize(static_cast<std::size_t>(std::min(left, copied_at_once)));
      reads = std::fread(piece.data(), 1, piece.size(), file.get()) == piece.size();
      out.write(piece);
    }
    if (!reads) throw IoError(tile.path + ": cannot be read any more");
  }
  out.commit();
}

template <int Dim>
Archive tiled_to_archive(const TiledField<Dim>& field, std::shared_ptr<const TileStore<Dim>>& tiles) {
  Archive archive;
  archive.kind = tiled_kind;
  set_box(archive, field.bounds());
  set_plan(archive, field.plan());
  archive.set("feature_size", field.feature_size());
  std::vector<double> factors;
  for (const typename TiledField<Dim>::Tile& tile : field.tiles()) {
    const auto* stored = dynamic_cast<const StoredField<Dim>*>(tile.inside.get());
    if (stored == nullptr) throw InvalidInput("write_model: field: fields of tiles have a file form only in files");
    archive.set("component", stored->part().component);
    archive.set("is_variance", stored->part().is_variance ? 1 : 0);
    factors.push_back(stored->factor());
    tiles = stored->tiles();
  }
  archive.set("factors", factors);
  return archive;
}

template <int Dim>
std::shared_ptr<const Field<Dim>> tiled_from(const Archive& archive, const Archive& whole,
                                             std::shared_ptr<const TileStore<Dim>>& tiles) {
  if (!tiles) {
    const auto& sizes = whole.array<std::int64_t>(tile_sizes_entry, -1, 1);
    std::vector<TilePlace> places;
    std::int64_t begin = whole.file_size;
    for (const std::int64_t size : sizes.reshaped()) {
      if (size < 0) whole.fail("a size of a tile is damaged");
      places.push_back({whole.source, begin, size});
      begin += size;
    }
    tiles = std::make_shared<const TileStore<Dim>>(std::move(places));
  }
  TilePlan<Dim> plan = plan_of<Dim>(archive);
  if (plan.size() != tiles->size()) archive.fail("the plan is not that of the tiles");
  const typename StoredField<Dim>::Part part{static_cast<Index>(archive.integer("component", 0, most_components)),
                                             archive.integer("is_variance", 0, 1) == 1};
  const std::vector<double> factors = archive.column("factors", plan.size());
  std::vector<typename TiledField<Dim>::Tile> fields;
  for (Index t = 0; t < plan.size(); ++t)
    fields.push_back({std::make_shared<const StoredField<Dim>>(tiles, t, part, factors[t]), nullptr});
  return std::make_shared<const TiledField<Dim>>(std::move(plan), std::move(fields), box_of<Dim>(archive),
                                                 archive.number("feature_size"));
}

template <int Dim>
void set_tile_sizes(Archive& archive, const TileStore<Dim>& tiles) {
  std::vector<std::int64_t> sizes;
  for (const TilePlace& place : tiles.places()) sizes.push_back(place.size);
  archive.set(tile_sizes_entry, sizes);
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

#define CSRBF_INSTANTIATE(Dim)                                                                            \
  template class TileStore<Dim>;                                                                          \
  template class StoredField<Dim>;                                                                        \
  template Archive tiled_to_archive<Dim>(const TiledField<Dim>&, std::shared_ptr<const TileStore<Dim>>&); \
  template std::shared_ptr<const Field<Dim>> tiled_from<Dim>(const Archive&, const Archive&,              \
                                                             std::shared_ptr<const TileStore<Dim>>&);     \
  template void set_tile_sizes<Dim>(Archive&, const TileStore<Dim>&);                                     \
  template void set_plan<Dim>(Archive&, const TilePlan<Dim>& plan);                                       \
  template TilePlan<Dim> plan_of<Dim>(const Archive&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
