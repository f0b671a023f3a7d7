#pragma once

#include "csrbf/approx/function.hpp"
#include "csrbf/approx/unity/tiled_field.hpp"
#include "csrbf/io/models/archive.hpp"
#include "csrbf/spatial/tile_plan.hpp"

#include <list>
#include <memory>
#include <mutex>

namespace csrbf {

/// Where a tile of a model is: the bytes of an archive.
struct TilePlace {
  std::string path;
  std::int64_t begin = 0, size = 0;
};

/// The tiles of a model: models of functions or surfaces of their own, one behind the other after the archive of the
/// whole, or each in a file. They are read when they are needed; those used last stay in memory, up to about 1 GB.
template <int Dim>
class TileStore {
 public:
  struct Tile {
    std::vector<std::shared_ptr<const Field<Dim>>> components, variances;
  };

  explicit TileStore(std::vector<TilePlace> places);

  [[nodiscard]] Index size() const { return std::ssize(places_); }
  [[nodiscard]] const std::vector<TilePlace>& places() const { return places_; }
  /// Thread safe. Throws IoError when the tile is damaged.
  [[nodiscard]] std::shared_ptr<const Tile> tile(Index number) const;

 private:
  struct Kept {
    Index number;
    std::shared_ptr<const Tile> tile;
  };

  [[nodiscard]] std::shared_ptr<const Tile> read(Index number) const;

  std::vector<TilePlace> places_;
  mutable std::mutex mutex_;
  mutable std::list<Kept> kept_;  // the one used last is the first
};

/// One component of a tile, or its variance, times a factor.
template <int Dim>
class StoredField final : public Field<Dim> {
 public:
  struct Part {
    Index component = 0;
    bool is_variance = false;
  };

  StoredField(std::shared_ptr<const TileStore<Dim>> tiles, Index tile, Part part, double factor)
      : tiles_(std::move(tiles)), tile_(tile), part_(part), factor_(factor) {}

  void evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<Dim> bounds() const override { return field()->bounds(); }
  [[nodiscard]] Points<Dim> seeds() const override { return field()->seeds(); }
  [[nodiscard]] double feature_size() const override { return field()->feature_size(); }

  [[nodiscard]] const Part& part() const { return part_; }
  [[nodiscard]] double factor() const { return factor_; }
  [[nodiscard]] const std::shared_ptr<const TileStore<Dim>>& tiles() const { return tiles_; }

 private:
  [[nodiscard]] std::shared_ptr<const Field<Dim>> field() const;

  std::shared_ptr<const TileStore<Dim>> tiles_;
  Index tile_;
  Part part_;
  double factor_;
};

/// The entry of a model in tiles with their sizes, in bytes.
inline constexpr const char* tile_sizes_entry = "tile_sizes";

/// The kind of archives of fields in tiles.
inline constexpr const char* tiled_kind = "fields of tiles";

/// What all tiles of a field have in common, and the store they are in. Throws InvalidInput for tiles in memory.
template <int Dim>
Archive tiled_to_archive(const TiledField<Dim>& field, std::shared_ptr<const TileStore<Dim>>& tiles);

/// The field again. `tiles`: of the fields that were read before, or null; `whole`: the archive that the tiles follow
/// in its file.
template <int Dim>
std::shared_ptr<const Field<Dim>> tiled_from(const Archive& archive, const Archive& whole,
                                             std::shared_ptr<const TileStore<Dim>>& tiles);

template <int Dim>
void set_tile_sizes(Archive& archive, const TileStore<Dim>& tiles);

/// The tiles of a function or of a surface; none where it is not in tiles.
std::vector<TilePlace> tile_places(const Function& function);
std::vector<TilePlace> tile_places(const Field<3>& surface);

/// Writes the archive of a model and its tiles behind it, one at a time: complete or not at all (AtomicFile). Throws
/// IoError; InvalidInput when a tile is in the file to be written.
void write_archive(const std::string& path, const Archive& archive, const std::vector<TilePlace>& tiles);

template <int Dim>
void set_plan(Archive& archive, const TilePlan<Dim>& plan);
/// Throws IoError or InvalidInput for damaged plans.
template <int Dim>
TilePlan<Dim> plan_of(const Archive& archive);

}  // namespace csrbf
