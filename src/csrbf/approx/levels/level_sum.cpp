#include "csrbf/approx/levels/level_sum.hpp"

#include "csrbf/approx/basis/evaluation_order.hpp"

namespace csrbf {

template <int Dim>
void LevelSum<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const Index n = x.cols();
  const Derivatives wanted = out.derivatives();
  Eigen::Map<Eigen::VectorXd> value(out.value, n);
  Eigen::Map<Eigen::VectorXd> gradient(out.gradient, wanted >= Derivatives::gradient ? Dim * n : 0);
  Eigen::Map<Eigen::VectorXd> hessian(out.hessian, wanted >= Derivatives::hessian ? symmetric_size<Dim> * n : 0);
  value.setZero();
  gradient.setZero();
  hessian.setZero();
  Jet<Dim> jet(n, wanted);
  for (const auto& level : levels_) {
    level->evaluate_block(x, {jet.value.data(), gradient.size() > 0 ? jet.gradient.data() : nullptr,
                              hessian.size() > 0 ? jet.hessian.data() : nullptr});
    value += jet.value;
    gradient += jet.gradient.reshaped();
    hessian += jet.hessian.reshaped();
  }
}

template <int Dim>
double LevelSum<Dim>::feature_size() const {
  double smallest = 0;
  for (const auto& level : levels_)
    if (level->feature_size() > 0)
      smallest = smallest > 0 ? std::min(smallest, level->feature_size()) : level->feature_size();
  return smallest;
}

template <int Dim>
std::optional<Enclosure> LevelSum<Dim>::enclose(const Box<Dim>& box) const {
  Enclosure sum;
  for (const auto& level : levels_) {
    const std::optional<Enclosure> part = level->enclose(box);
    if (!part) return std::nullopt;
    sum = {sum.lo + part->lo, sum.hi + part->hi, sum.lipschitz + part->lipschitz,
           sum.hessian_bound + part->hessian_bound};
  }
  return sum;
}

template <int Dim>
std::vector<Index> LevelSum<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  return evaluation_order_of<Dim>(x);
}

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> LevelFit<Dim>::model() const {
  return {fields.begin(), fields.end()};
}

#define CSRBF_INSTANTIATE(Dim)  \
  template class LevelSum<Dim>; \
  template std::vector<std::shared_ptr<const Field<Dim>>> LevelFit<Dim>::model() const;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
