#include "csrbf/approx/unity/cell_constants.hpp"

#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"

namespace csrbf {

template <int Dim>
std::vector<std::shared_ptr<const Field<Dim>>> cell_constants(Cover<Dim> cover, const Eigen::MatrixXd& values) {
  using Data = PartitionOfUnityData<Dim>;
  auto data = std::make_shared<Data>(Data{std::move(cover), {}});
  LocalModels<Dim>& models = data->models;
  models.components = values.rows();
  models.resize(data->cover.size());
  require(values.cols() == models.size(), "cell_constants", "columns of values", values.cols(),
          "there must be one per cell");
  for (Index i = 0; i < models.size(); ++i) {
    const Box<Dim>& cell = data->cover.cell(i);
    models.center.col(i) = cell.center();
    models.radius[i] = 0.5 * cell.diagonal();
  }
  std::copy_n(values.data(), values.size(), models.polynomial.begin());
  return PartitionOfUnityFit<Dim>{data, {}}.fields();
}

#define CSRBF_INSTANTIATE(Dim) \
  template std::vector<std::shared_ptr<const Field<Dim>>> cell_constants<Dim>(Cover<Dim>, const Eigen::MatrixXd&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
