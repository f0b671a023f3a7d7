#include "csrbf/io/models/frame_archive.hpp"

#include "csrbf/approx/fit_options.hpp"

namespace csrbf {

template <int Dim>
Archive frame_to_archive(const typename FittedField<Dim>::Frame& frame) {
  Archive archive;
  archive.kind = fitted_kind;
  archive.set("scales", frame.scales);
  archive.set("periods", frame.periods);
  set_box(archive, frame.box);
  archive.set("extrapolation", name_of(frame.extrapolation));
  archive.set("rim", frame.rim);
  archive.set("unit", frame.unit);
  archive.set("growth", Eigen::Vector3d(frame.growth.amount, frame.growth.exponent, frame.growth.largest));
  return archive;
}

template <int Dim>
typename FittedField<Dim>::Frame frame_from(const Archive& archive) {
  typename FittedField<Dim>::Frame frame;
  frame.scales = archive.numbers("scales", Dim, 1);
  frame.periods = archive.numbers("periods", Dim, 1);
  frame.box = box_of<Dim>(archive);
  frame.extrapolation = extrapolation_of(archive.text("extrapolation"));
  if (archive.has("rim")) frame.rim = archive.numbers("rim", Dim, 1);
  if (archive.has("growth")) {  // older models have none
    const Eigen::MatrixXd growth = archive.numbers("growth", 3, 1);
    frame.growth = {growth(0), growth(1), growth(2)};
    frame.unit = archive.number("unit");
  }
  if (!(frame.scales.minCoeff() > 0) || !(frame.periods.minCoeff() >= 0) || !(frame.rim.minCoeff() >= 0) ||
      frame.box.empty() || !frame.box.extent().allFinite())
    archive.fail("the frame is damaged");
  return frame;
}

#define CSRBF_INSTANTIATE(Dim)                                                     \
  template Archive frame_to_archive<Dim>(const typename FittedField<Dim>::Frame&); \
  template typename FittedField<Dim>::Frame frame_from<Dim>(const Archive&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
