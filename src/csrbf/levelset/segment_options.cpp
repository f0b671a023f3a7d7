#include "csrbf/levelset/segment_options.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace csrbf {
namespace {

template <class Enum, std::size_t n>
using Names = std::array<std::pair<Enum, std::string_view>, n>;

constexpr Names<SegmentEnergy, 6> energies{{{SegmentEnergy::chan_vese, "chan-vese"},
                                            {SegmentEnergy::gaussian, "gaussian"},
                                            {SegmentEnergy::generalized_gaussian, "generalized-gaussian"},
                                            {SegmentEnergy::rayleigh, "rayleigh"},
                                            {SegmentEnergy::gamma, "gamma"},
                                            {SegmentEnergy::edge, "edge"}}};
constexpr Names<SegmentMode, 2> modes{{{SegmentMode::global, "global"}, {SegmentMode::local, "local"}}};
constexpr Names<SegmentMethod, 3> methods{{{SegmentMethod::variational, "variational"},
                                           {SegmentMethod::collocation, "collocation"},
                                           {SegmentMethod::finite_difference, "finite-difference"}}};
constexpr Names<Shading, 4> shadings{{{Shading::automatic, "auto"},
                                      {Shading::none, "none"},
                                      {Shading::linear, "linear"},
                                      {Shading::quadratic, "quadratic"}}};

template <class Enum, std::size_t n>
std::string_view name_in(const Names<Enum, n>& names, Enum value) {
  for (const auto& [known, name] : names)
    if (known == value) return name;
  return "";
}

template <class Enum, std::size_t n>
Enum named_in(const Names<Enum, n>& names, std::string_view name, std::string_view what) {
  std::vector<std::string> known;
  for (const auto& [value, its_name] : names) {
    if (its_name == name) return value;
    known.emplace_back(its_name);
  }
  throw InvalidInput("segment: " + std::string(what) + " = " + std::string(name) + ": must be one of " + joined(known));
}

}  // namespace

std::string_view name_of(SegmentEnergy energy) {
  return name_in(energies, energy);
}
std::string_view name_of(SegmentMode mode) {
  return name_in(modes, mode);
}
std::string_view name_of(SegmentMethod method) {
  return name_in(methods, method);
}
std::string_view name_of(Shading shading) {
  return name_in(shadings, shading);
}
SegmentEnergy segment_energy(std::string_view name) {
  return named_in(energies, name, "energy");
}
SegmentMode segment_mode(std::string_view name) {
  return named_in(modes, name, "mode");
}
SegmentMethod segment_method(std::string_view name) {
  return named_in(methods, name, "method");
}
Shading shading_named(std::string_view name) {
  return named_in(shadings, name, "shading");
}

}  // namespace csrbf
