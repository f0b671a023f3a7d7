#include "csrbf/tiles/folder/tile_work.hpp"

#include "csrbf/io/models/tile_store.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr const char* work_kind = "tile work";

}  // namespace

template <int Dim>
void write_work(const TileFolder& folder, const TileWork<Dim>& work) {
  Archive archive;
  archive.kind = work_kind;
  archive.set("dimension", Dim);
  archive.set("fingerprint", work.fingerprint);
  archive.set("points", work.points);
  archive.set("non_finite", work.non_finite);
  archive.set("shares", work.shares);
  archive.set("first_numbers", work.first_numbers);
  archive.set("payload", work.payload);
  set_box(archive, work.bounds);
  archive.set("spacing", work.spacing);
  archive.set("halo", work.halo);
  archive.set("boxed", work.boxed ? 1 : 0);
  archive.set("grid_origin", work.grid.origin);
  archive.set("grid_cube", work.grid.cube);
  archive.set("grid_bits", work.grid.spacing_bits);
  set_plan(archive, work.plan);
  archive.set("notes", work.notes);
  write_archive(folder.file("work"), archive);
}

template <int Dim>
TileWork<Dim> read_work(const TileFolder& folder) {
  const Archive archive = read_archive(folder.file("work"));
  if (archive.kind != work_kind || archive.integer("dimension") != Dim)
    archive.fail("this is no work in tiles of " + std::to_string(Dim) + " coordinates");
  TileWork<Dim> work;
  work.fingerprint = archive.text("fingerprint");
  work.points = archive.integer("points");
  work.non_finite = archive.integer("non_finite");
  work.shares = archive.integer("shares", 1, std::numeric_limits<std::int32_t>::max());
  const auto& first = archive.array<std::int64_t>("first_numbers", -1, 1);
  work.first_numbers.assign(first.data(), first.data() + first.size());
  work.payload = static_cast<std::size_t>(archive.integer("payload", 0, 1 << 20));
  work.bounds = box_of<Dim>(archive);
  work.spacing = archive.number("spacing");
  work.halo = archive.number("halo");
  work.boxed = archive.integer("boxed") != 0;
  work.grid.origin = archive.numbers("grid_origin", Dim, 1);
  work.grid.cube = archive.number("grid_cube");
  work.grid.spacing_bits = static_cast<int>(archive.integer("grid_bits", 0, ThinningGrid<Dim>::bits));
  work.plan = plan_of<Dim>(archive);
  work.notes = archive.part("notes");
  return work;
}

#define CSRBF_INSTANTIATE(Dim)                                                 \
  template void write_work<Dim>(const TileFolder&, const TileWork<Dim>& work); \
  template TileWork<Dim> read_work<Dim>(const TileFolder&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
