#include "csrbf/kernels/kernel.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/kernels/compact_kernels.hpp"
#include "csrbf/kernels/global_kernels.hpp"
#include "csrbf/kernels/wendland.hpp"

namespace csrbf {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr int analytic = 100;  // the smoothness reported for kernels with all derivatives
constexpr int any_dimension = std::numeric_limits<int>::max();

enum class Family {
  wendland,
  missing_wendland,
  wu,
  buhmann,
  gaussian,
  powered_exponential,
  matern,
  inverse_multiquadric,
  multiquadric,
  power
};

struct Entry {
  std::string_view name;
  Family family;
  int derivatives;          // of the compact families
  int largest_dimension;    // in which it is (conditionally) positive definite
  double parameter;         // fixed value, or the default
  bool adjustable = false;  // whether a parameter may be given
};

constexpr Entry entries[] = {
    {"wendland-c0", Family::wendland, 0, any_dimension, none},
    {"wendland-c2", Family::wendland, 2, any_dimension, none},
    {"wendland-c4", Family::wendland, 4, any_dimension, none},
    {"wendland-c6", Family::wendland, 6, any_dimension, none},
    {"missing-wendland", Family::missing_wendland, 1, 2, none},
    {"wu-c0", Family::wu, 0, 7, none},
    {"wu-c2", Family::wu, 2, 5, none},
    {"wu-c4", Family::wu, 4, 3, none},
    {"wu-c6", Family::wu, 6, 1, none},
    {"buhmann-c1", Family::buhmann, 1, 6, none},
    {"buhmann-c2", Family::buhmann, 2, 4, none},
    {"buhmann-c3", Family::buhmann, 3, 3, none},
    {"gaussian", Family::gaussian, analytic, any_dimension, none},
    {"powered-exponential", Family::powered_exponential, 0, any_dimension, 1.4, true},
    {"matern-c0", Family::matern, 0, any_dimension, .5},
    {"matern-c2", Family::matern, 2, any_dimension, 1.5},
    {"matern-c4", Family::matern, 4, any_dimension, 2.5},
    {"matern-c6", Family::matern, 6, any_dimension, 3.5},
    {"matern", Family::matern, 0, any_dimension, 1.5, true},
    {"inverse-multiquadric", Family::inverse_multiquadric, analytic, any_dimension, .5, true},
    {"inverse-quadratic", Family::inverse_multiquadric, analytic, any_dimension, 1},
    {"multiquadric", Family::multiquadric, analytic, any_dimension, .5, true},
    {"linear", Family::power, 0, any_dimension, 1},
    {"cubic", Family::power, 2, any_dimension, 3},
    {"quintic", Family::power, 4, any_dimension, 5},
    {"septic", Family::power, 6, any_dimension, 7},
    {"polyharmonic", Family::power, 0, any_dimension, 3, true},
    {"thin-plate", Family::power, 1, any_dimension, 2},
    {"thin-plate-r4", Family::power, 3, any_dimension, 4},
};

// What other programs call our kernels.
constexpr std::pair<std::string_view, std::string_view> other_names[] = {
    {"thin-plate-spline", "thin-plate"},
    {"tps", "thin-plate"},
    {"thinplate", "thin-plate"},
    {"inverse", "inverse-multiquadric"},
    {"squared-exponential", "gaussian"},
    {"rbf", "gaussian"},
    {"exponential", "matern-c0"},
    {"matern12", "matern-c0"},
    {"matern32", "matern-c2"},
    {"matern52", "matern-c4"},
    {"biharmonic", "linear"},
    {"triharmonic", "cubic"},
    {"wendland", "wendland-c2"},
};

// Our name for a kernel, with hyphens.
std::string our_name(std::string_view name) {
  std::string ours(name);
  std::replace(ours.begin(), ours.end(), '_', '-');
  for (const auto& [other, known] : other_names)
    if (other == ours) return std::string(known);
  return ours;
}

const Entry& find(std::string_view given, int dimension) {
  require(dimension >= 1, "kernel", "dimension", dimension, "must be at least 1; give the dimension of the points");
  const std::string name = our_name(given);
  for (const Entry& entry : entries) {
    if (entry.name != name) continue;
    if (dimension > entry.largest_dimension)
      throw InvalidInput("kernel = " + std::string(name) + ": is positive definite only up to dimension " +
                         std::to_string(entry.largest_dimension) + ", not in " + std::to_string(dimension) +
                         "; use one of " + joined(Kernel::names(dimension)));
    return entry;
  }
  throw InvalidInput("kernel = " + std::string(name) + ": unknown; " + did_you_mean(name, Kernel::names(dimension)) +
                     "use one of " + joined(Kernel::names(dimension)));
}

bool is_integer(double x) {
  return std::floor(x) == x;
}

// The parameter to use, checked.
double resolve(const Entry& entry, double parameter) {
  if (std::isnan(parameter)) return entry.parameter;
  const std::string kernel = " of " + std::string(entry.name);
  require(entry.adjustable, "kernel", "parameter" + kernel, parameter, "this kernel has none; leave it out");
  constexpr double largest = 50;  // chosen by hand: beyond any use, and r^50 is far from overflow
  require(parameter > 0 && parameter <= largest, "kernel", "parameter" + kernel, parameter,
          "must be positive and at most 50");
  require(entry.family != Family::powered_exponential || parameter <= 2, "kernel", "parameter" + kernel, parameter,
          "must be at most 2: larger ones are not positive definite");
  require(entry.family != Family::multiquadric || !is_integer(parameter), "kernel", "parameter" + kernel, parameter,
          "must not be an integer, or the kernel is a polynomial");
  return parameter;
}

std::shared_ptr<const RadialFunction> make_function(const Entry& entry, int dimension, double parameter) {
  switch (entry.family) {
    case Family::wendland:
      return wendland_function(dimension, entry.derivatives / 2);
    case Family::missing_wendland:
      return missing_wendland_function();
    case Family::wu:
      return wu_function(dimension, entry.derivatives);
    case Family::buhmann:
      return buhmann_function(entry.derivatives);
    case Family::gaussian:
      return gaussian_function();
    case Family::powered_exponential:
      return powered_exponential_function(parameter);
    case Family::matern:
      return matern_function(parameter);
    case Family::inverse_multiquadric:
      return multiquadric_function(-parameter);
    case Family::multiquadric:
      return multiquadric_function(parameter);
    default:
      return polyharmonic_function(parameter);
  }
}

int order_of(Family family, double parameter) {
  if (family == Family::multiquadric) return static_cast<int>(std::ceil(parameter));
  if (family != Family::power) return 0;
  const double half = parameter / 2;
  return static_cast<int>(is_integer(half) ? half + 1 : std::ceil(half));
}

int smoothness_of(const Entry& entry, double parameter) {
  if (entry.family == Family::matern) return static_cast<int>(std::ceil(2 * parameter)) - 1;
  if (entry.family == Family::powered_exponential && parameter == 2) return analytic;
  if (entry.family == Family::power || entry.family == Family::powered_exponential)
    return static_cast<int>(std::ceil(parameter)) - 1;
  return entry.derivatives;
}

}  // namespace

Kernel::Kernel(std::string_view name, int dimension, double parameter) : dimension_(dimension) {
  const Entry& entry = find(name, dimension);
  name_ = entry.name;
  parameter = resolve(entry, parameter);
  parameter_ = entry.adjustable ? parameter : none;
  compact_ = entry.family <= Family::buhmann;
  has_scale_ = entry.family != Family::power;
  order_ = order_of(entry.family, parameter);
  smoothness_ = smoothness_of(entry, parameter);
  function_ = make_function(entry, dimension, parameter);
}

double Kernel::value(double r) const {
  double phi = 0;
  const double r2 = r * r;
  function_->evaluate(&r2, 1, {&phi});
  return phi;
}

double Kernel::g(double r) const {
  double phi = 0, g = 0;
  const double r2 = r * r;
  function_->evaluate(&r2, 1, {&phi, &g});
  return g;
}

double Kernel::h(double r) const {
  double phi = 0, g = 0, h = 0;
  const double r2 = r * r;
  function_->evaluate(&r2, 1, {&phi, &g, &h});
  return h;
}

double Kernel::q(double r) const {
  const double second = r * r == 0 ? 0 : h(r);
  return second == 0 ? 0 : r * r * second;  // 0 also where r * r overflows
}

double Kernel::laplacian(double r) const {
  return dimension_ * g(r) + q(r);
}

void Kernel::values(const double* r2, Index n, double* phi) const {
  function_->evaluate(r2, n, {phi});
}

void Kernel::gradients(const double* r2, Index n, double* phi, double* g) const {
  function_->evaluate(r2, n, {phi, g});
}

void Kernel::hessians(const double* r2, Index n, double* phi, double* g, double* h) const {
  function_->evaluate(r2, n, {phi, g, h});
}

std::vector<std::string> Kernel::names(int dimension) {
  std::vector<std::string> names;
  for (const Entry& entry : entries)
    if (dimension <= entry.largest_dimension) names.emplace_back(entry.name);
  return names;
}

}  // namespace csrbf
