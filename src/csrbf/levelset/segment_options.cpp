#include "csrbf/levelset/segment_options.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"

namespace csrbf {
namespace {

// In the order of the enumerators.
constexpr std::array<std::string_view, 7> energies{"auto",     "chan-vese", "gaussian", "generalized-gaussian",
                                                   "rayleigh", "gamma",     "edge"};
constexpr std::array<std::string_view, 2> modes{"global", "local"};
constexpr std::array<std::string_view, 3> methods{"variational", "collocation", "finite-difference"};
constexpr std::array<std::string_view, 7> shadings{"auto",   "none",    "linear",    "quadratic",
                                                   "smooth", "objects", "background"};

template <class Enum, std::size_t n>
Enum named_in(const std::array<std::string_view, n>& names, std::string_view name, std::string_view what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<Enum>(found - names.begin());
  throw InvalidInput("segment: " + std::string(what) + " = " + std::string(name) + ": must be one of " +
                     joined({names.begin(), names.end()}));
}

}  // namespace

std::string_view name_of(SegmentEnergy energy) {
  return energies[static_cast<std::size_t>(energy)];
}
std::string_view name_of(SegmentMode mode) {
  return modes[static_cast<std::size_t>(mode)];
}
std::string_view name_of(SegmentMethod method) {
  return methods[static_cast<std::size_t>(method)];
}
std::string_view name_of(Shading shading) {
  return shadings[static_cast<std::size_t>(shading)];
}
SegmentEnergy segment_energy(std::string_view name) {
  return named_in<SegmentEnergy>(energies, name, "energy");
}
SegmentMode segment_mode(std::string_view name) {
  return named_in<SegmentMode>(modes, name, "mode");
}
SegmentMethod segment_method(std::string_view name) {
  return named_in<SegmentMethod>(methods, name, "method");
}
Shading shading_named(std::string_view name) {
  return named_in<Shading>(shadings, name, "shading");
}

}  // namespace csrbf
