#include "csrbf/implicit/combine.hpp"

namespace csrbf {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

Enclosure complement_of(const Enclosure& e) {
  return {-e.hi, -e.lo, e.lipschitz, e.hessian_bound};
}

// Of max f_i: if only one of them can be the largest, its enclosure; else gradients may jump.
Enclosure sharp_union(const std::vector<Enclosure>& parts) {
  Enclosure result{-infinite, -infinite, 0, 0};
  for (const Enclosure& part : parts) {
    result.lo = std::max(result.lo, part.lo);
    result.hi = std::max(result.hi, part.hi);
  }
  int possible = 0;
  for (const Enclosure& part : parts) {
    if (part.hi < result.lo) continue;
    ++possible;
    result.lipschitz = std::max(result.lipschitz, part.lipschitz);
    result.hessian_bound = std::max(result.hessian_bound, part.hessian_bound);
  }
  if (possible > 1) result.hessian_bound = infinite;
  return result;
}

// Smallest |x| of an interval.
double smallest_magnitude(const Enclosure& e) {
  return std::max({0.0, e.lo, -e.hi});
}

// Of f + g + rho, rho = sqrt(f^2 + g^2): it increases with f and g, at most twice as fast; the second derivatives of
// rho are at most 1 / rho.
Enclosure r_union(const Enclosure& f, const Enclosure& g) {
  const double rho = std::hypot(smallest_magnitude(f), smallest_magnitude(g));
  const double slopes = f.lipschitz * f.lipschitz + g.lipschitz * g.lipschitz;
  const auto value = [](double a, double b) { return a + b + std::hypot(a, b); };
  return {value(f.lo, g.lo), value(f.hi, g.hi), 2 * (f.lipschitz + g.lipschitz),
          rho > 0 ? 2 * (f.hessian_bound + g.hessian_bound) + slopes / rho : infinite};
}

double super_elliptic(const std::vector<double>& f, double R, double b) {
  const double most = *std::max_element(f.begin(), f.end()), unit = 1 + most / R;
  if (!(unit > 0)) return most;
  double sum = 0;
  for (const double part : f) sum += std::pow(std::max(0.0, 1 + part / R) / unit, b);
  return R * (unit * std::pow(sum, 1 / b) - 1);
}

// The weights of the gradients are (v_i / |v|_b)^(b - 1) with v_i = 1 + f_i / R, so that by Hoelder's inequality their
// sum is at most n^(1/b); second derivatives with respect to the f_i are at most (b - 1) / (R |v|_b) for b >= 2.
Enclosure super_elliptic_union(const std::vector<Enclosure>& parts, double R, double b) {
  std::vector<Enclosure> reached;
  for (const Enclosure& part : parts)
    if (part.hi > -R) reached.push_back(part);
  if (reached.empty()) return sharp_union(parts);
  if (reached.size() == 1 && reached.front().lo >= -R) return reached.front();
  std::vector<double> lo, hi;
  double slope = 0, bend = 0, squares = 0;
  for (const Enclosure& part : parts) {
    lo.push_back(part.lo);
    hi.push_back(part.hi);
    slope = std::max(slope, part.lipschitz);
    bend = std::max(bend, part.hessian_bound);
    squares += part.lipschitz * part.lipschitz;
  }
  const double factor = std::pow(static_cast<double>(parts.size()), 1 / b);
  Enclosure result{super_elliptic(lo, R, b), super_elliptic(hi, R, b), factor * slope, infinite};
  if (b >= 2 && result.lo > -R) result.hessian_bound = factor * bend + (b - 1) / (R + result.lo) * squares;
  return result;
}

// The weights of the gradients are positive with sum 1, and the second derivatives form their covariance times b / R.
Enclosure log_sum_exp_union(const std::vector<Enclosure>& parts, double R, double b) {
  Enclosure result = sharp_union(parts);
  const auto value = [&](auto member) {
    double most = -infinite, sum = 0;
    for (const Enclosure& part : parts) most = std::max(most, part.*member);
    for (const Enclosure& part : parts) sum += std::exp(b / R * (part.*member - most));
    return most + R / b * std::log(sum);
  };
  result.lo = value(&Enclosure::lo);
  result.hi = value(&Enclosure::hi);
  result.lipschitz = result.hessian_bound = 0;
  for (const Enclosure& part : parts) {
    result.lipschitz = std::max(result.lipschitz, part.lipschitz);
    result.hessian_bound = std::max(result.hessian_bound, part.hessian_bound);
  }
  result.hessian_bound += b / R * result.lipschitz * result.lipschitz;
  return result;
}

Enclosure united(const std::vector<Enclosure>& parts, const CombinedField::Data& data) {
  if (parts.size() == 1) return parts.front();
  switch (data.blending) {
    case Blending::super_elliptic:
      return super_elliptic_union(parts, data.range, data.sharpness);
    case Blending::log_sum_exp:
      return log_sum_exp_union(parts, data.range, data.sharpness);
    case Blending::r_function: {
      Enclosure result = parts.front();
      for (std::size_t i = 1; i < parts.size(); ++i) result = r_union(result, parts[i]);
      return result;
    }
    case Blending::sharp:
      break;
  }
  return sharp_union(parts);
}

}  // namespace

std::optional<Enclosure> CombinedField::enclose(const Box<3>& box) const {
  std::vector<Enclosure> parts;
  for (const Term& term : data_.terms) {
    const std::optional<Enclosure> part = term.solid->enclose(box);
    if (!part) return std::nullopt;
    parts.push_back(term.complemented ? complement_of(*part) : *part);
  }
  const Enclosure result = united(parts, data_);
  return data_.complemented ? complement_of(result) : result;
}

}  // namespace csrbf
