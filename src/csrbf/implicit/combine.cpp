#include "csrbf/implicit/combine.hpp"

#include "csrbf/implicit/combine/extend_distance.hpp"

#include <utility>

namespace csrbf {
namespace {

constexpr std::array<std::string_view, 4> operation_names = {"union", "intersection", "difference", "complement"};
constexpr std::array<std::string_view, 4> blending_names = {"sharp", "r-function", "super-elliptic", "log-sum-exp"};

template <class Value>
std::optional<Value> find_name(const std::array<std::string_view, 4>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<Value>(found - names.begin());
}

bool holds_infinity_of(const Field<3>& field) {
  if (const auto* combined = dynamic_cast<const CombinedField*>(&field)) return combined->holds_infinity();
  if (const auto* extended = dynamic_cast<const ExtendedField*>(&field))
    return holds_infinity_of(*extended->data().inner);
  return false;
}

// Largest amount by which the blend of n functions exceeds the largest of them.
double largest_bulge(const CombinedField::Data& data) {
  const auto n = static_cast<double>(data.terms.size());
  if (data.blending == Blending::super_elliptic) return data.range * (std::pow(n, 1 / data.sharpness) - 1);
  if (data.blending == Blending::log_sum_exp) return data.range * std::log(n) / data.sharpness;
  return 0;
}

Box<3> common_part(const Box<3>& a, const Box<3>& b) {
  return {a.lo.cwiseMax(b.lo), a.hi.cwiseMin(b.hi)};
}

void check_solids(Operation operation, const std::vector<Solid>& solids, const CombineOptions& options) {
  constexpr const char* f = "combine";
  const bool one = operation == Operation::complement;
  require(one ? solids.size() == 1 : solids.size() >= 2, f, "number of solids", solids.size(),
          one ? "the complement takes exactly one solid" : "at least two are needed");
  for (const Solid& solid : solids) require(solid != nullptr, f, "solid", "null", "must point to a field");
  if (!has_range(options.blending)) return;
  require(options.radius > 0 && std::isfinite(options.radius), f, "radius", options.radius,
          "must be positive and finite; for sharp edges set blending to sharp");
  require(options.sharpness >= 1 && std::isfinite(options.sharpness), f, "sharpness", options.sharpness,
          "must be at least 1 and finite");
}

Box<3> box_of(const std::vector<Solid>& solids) {
  Box<3> box;
  for (const Solid& solid : solids) box.add(solid->bounds());
  return box;
}

}  // namespace

std::string_view name_of(Operation operation) {
  return operation_names[static_cast<std::size_t>(operation)];
}

std::string_view name_of(Blending blending) {
  return blending_names[static_cast<std::size_t>(blending)];
}

std::optional<Operation> operation_named(std::string_view name) {
  return find_name<Operation>(operation_names, name);
}

std::optional<Blending> blending_named(std::string_view name) {
  return find_name<Blending>(blending_names, name);
}

Solid combine(Operation operation, const std::vector<Solid>& solids, const CombineOptions& options) {
  check_solids(operation, solids, options);
  CombinedField::Data data;
  data.complemented = operation != Operation::unite;
  data.blending = options.blending;
  data.sharpness = options.sharpness;
  if (has_range(options.blending) && operation != Operation::complement)
    data.range = options.radius * box_of(solids).diagonal();
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const bool complemented = operation == Operation::intersect || (operation == Operation::subtract && i == 0);
    const double feature_size = solids[i]->feature_size();
    const bool far_reaching = feature_size > 0 && feature_size < data.range;
    data.terms.push_back(
        {far_reaching ? extend_distance(solids[i], data.range, options.progress) : solids[i], complemented});
  }
  return std::make_shared<const CombinedField>(std::move(data));
}

bool CombinedField::holds_infinity() const {
  bool any = false;
  for (const Term& term : data_.terms) any = any || holds_infinity_of(*term.solid) != term.complemented;
  return any != data_.complemented;
}

// A union of solids lies in the union of their boxes. If some of them contain everything far away, the outside of the
// union lies in the boxes of all of those.
Box<3> CombinedField::bounds() const {
  Box<3> all, common;
  bool unbounded = false;
  for (const Term& term : data_.terms) {
    const Box<3> box = term.solid->bounds();
    all.add(box);
    if (holds_infinity_of(*term.solid) == term.complemented) continue;
    common = unbounded ? common_part(common, box) : box;
    unbounded = true;
  }
  // If the boxes are disjoint the surface is empty, and any box will do.
  if (unbounded) return common.empty() ? data_.terms.front().solid->bounds() : common;
  return all.inflated(largest_bulge(data_));
}

Points<3> CombinedField::seeds() const {
  std::vector<Points<3>> parts;
  Index count = 0;
  for (const Term& term : data_.terms) {
    parts.push_back(term.solid->seeds());
    if (parts.back().cols() == 0) return Points<3>(3, 0);
    count += parts.back().cols();
  }
  Points<3> seeds(3, count);
  Index begin = 0;
  for (const Points<3>& part : parts) {
    seeds.middleCols(begin, part.cols()) = part;
    begin += part.cols();
  }
  return seeds;
}

double CombinedField::feature_size() const {
  double smallest = 0;
  for (const Term& term : data_.terms) {
    const double feature_size = term.solid->feature_size();
    if (feature_size > 0 && (smallest == 0 || feature_size < smallest)) smallest = feature_size;
  }
  return smallest;
}

std::vector<Index> CombinedField::evaluation_order(const PointsRef<3>& x) const {
  for (const Term& term : data_.terms) {
    std::vector<Index> order = term.solid->evaluation_order(x);
    if (!order.empty()) return order;
  }
  return {};
}

Solid operator|(const Solid& a, const Solid& b) {
  return combine(Operation::unite, {a, b});
}

Solid operator&(const Solid& a, const Solid& b) {
  return combine(Operation::intersect, {a, b});
}

Solid operator-(const Solid& a, const Solid& b) {
  return combine(Operation::subtract, {a, b});
}

Solid operator~(const Solid& a) {
  return combine(Operation::complement, {a});
}

}  // namespace csrbf
