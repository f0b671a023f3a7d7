#pragma once

#include "csrbf/core/field.hpp"
#include "csrbf/core/progress.hpp"

#include <memory>

namespace csrbf {

/// A solid {f > 0}, with shared ownership.
using Solid = std::shared_ptr<const Field<3>>;

/// Operations of combine() on solids A, B, ...
enum class Operation {
  unite,       ///< in any of them
  intersect,   ///< in all of them
  subtract,    ///< in A and in none of the others
  complement,  ///< not in A, the only one
};

/// How the union U of functions f_i is formed (thesis 4.2). The other operations follow from it: the intersection of f
/// and g is -U(-f, -g), the difference -U(-f, g).
enum class Blending {
  sharp,           ///< max f_i (the thesis prints min); not smooth where surfaces cross: edges
  r_function,      ///< f + g + sqrt(f^2 + g^2), pairwise: the same surface with the same edges, smooth elsewhere
  super_elliptic,  ///< R (sum max(0, 1 + f_i / R)^b)^(1/b) - R: rounds edges; surfaces farther apart than the range R
                   ///< do not change. C2 for b > 2; b = 1, the linear blend, chamfers edges
  log_sum_exp,  ///< R/b log sum exp(b f_i / R): smooth of all orders; max <= U <= max + R/b log n, also far from edges
};

/// union, intersection, difference, complement.
std::string_view name_of(Operation operation);
/// sharp, r-function, super-elliptic, log-sum-exp.
std::string_view name_of(Blending blending);
/// The operation or blending with this name, if there is one.
std::optional<Operation> operation_named(std::string_view name);
std::optional<Blending> blending_named(std::string_view name);

/// Whether the options radius and sharpness apply to the blending.
inline bool has_range(Blending blending) {
  return blending == Blending::super_elliptic || blending == Blending::log_sum_exp;
}

struct CombineOptions {
  Blending blending = Blending::sharp;
  /// Range R of the blend, as a fraction of the diagonal of the box of all solids, above 0. For super_elliptic and
  /// log_sum_exp.
  double radius = 0.05;
  /// Exponent b of these two blends, at least 1: larger values follow the edge more closely.
  double sharpness = 3;
  Progress progress{};  ///< stages of polygonize() and "extend"
};

/// The union, intersection, difference or complement of solids, which is again a solid: with exact derivatives, its own
/// box, and seeds and feature size if all solids have them. Its values are distances where those of the solids are.
/// Blends need distances within their range. So a solid whose feature size is known and smaller than that is first
/// extended to have them there, which costs a polygonization.
///
/// Throws InvalidInput for fewer than two solids (complement: other than one), null pointers, and options out of range;
/// as polygonize() if solids must be extended.
Solid combine(Operation operation, const std::vector<Solid>& solids, const CombineOptions& options = {});

/// Sharp union, intersection, difference and complement.
Solid operator|(const Solid& a, const Solid& b);
Solid operator&(const Solid& a, const Solid& b);
Solid operator-(const Solid& a, const Solid& b);
Solid operator~(const Solid& a);

/// What combine() returns.
class CombinedField final : public Field<3> {
 public:
  struct Term {
    Solid solid;
    bool complemented = false;  ///< use -f
  };
  /// f = U(+- f_i), or -U if the whole is complemented.
  struct Data {
    std::vector<Term> terms;  ///< at least one
    bool complemented = false;
    Blending blending = Blending::sharp;
    double range = 0;      ///< R, a length
    double sharpness = 3;  ///< b
  };

  explicit CombinedField(Data data) : data_(std::move(data)) {}

  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override;
  [[nodiscard]] Box<3> bounds() const override;
  /// The seeds of all solids; some may be far from the surface of the result.
  [[nodiscard]] Points<3> seeds() const override;
  /// The smallest feature size of the solids.
  [[nodiscard]] double feature_size() const override;
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<3>& x) const override;

  /// From the enclosures of the solids, if all have one.
  [[nodiscard]] std::optional<Enclosure> enclose(const Box<3>& box) const override;

  /// Whether points far away are inside.
  [[nodiscard]] bool holds_infinity() const;

  [[nodiscard]] const Data& data() const { return data_; }

 private:
  template <class Scalar>
  void evaluate_as(const PointsRef<3>& x, const JetBlock& out) const;

  Data data_;
};

}  // namespace csrbf
