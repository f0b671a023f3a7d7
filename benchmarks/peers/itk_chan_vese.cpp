// The region-based level sets of ITK (Chan and Vese), to compare csrbf with.
// usage: itk_chan_vese IMAGE.npy LABELS.npy COST.json (ball|balls) CURVATURE

#include "cost.hpp"

#include "csrbf/io/volume.hpp"

#include <itkAtanRegularizedHeavisideStepFunction.h>
#include <itkImage.h>
#include <itkScalarChanAndVeseDenseLevelSetImageFilter.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <string>

namespace {

struct Parameters {
  bool balls;
  double curvature;
  const char* cost_file;
};

template <int Dim>
csrbf::Volume<float> segment(const csrbf::Volume<float>& given, const Parameters& parameters) {
  using Image = itk::Image<float, Dim>;
  using Data = itk::ScalarChanAndVeseLevelSetFunctionData<Image, Image>;
  using Shared = itk::ConstrainedRegionBasedLevelSetFunctionSharedData<Image, Image, Data>;
  using Speed = itk::ScalarChanAndVeseLevelSetFunction<Image, Image, Shared>;
  using Filter = itk::ScalarChanAndVeseDenseLevelSetImageFilter<Image, Image, Image, Speed, Shared>;

  const Cost cost;
  typename Image::SizeType size;
  typename Image::RegionType region;
  for (int a = 0; a < Dim; ++a) size[a] = static_cast<itk::SizeValueType>(given.grid.size[a]);
  region.SetSize(size);
  const auto allocate = [&region] {
    const auto image = Image::New();
    image->SetRegions(region);
    image->Allocate();
    return image;
  };
  // Intensities from 0 to 255; the start is a ball half as wide as the picture, or many small ones; negative inside.
  constexpr double period = 40;
  const auto feature = allocate(), start = allocate();
  const auto [low, high] = std::minmax_element(given.values.begin(), given.values.end());
  for (std::size_t i = 0; i < given.values.size(); ++i) {
    feature->GetBufferPointer()[i] = 255 * (given.values[i] - *low) / (*high - *low);
    double squares = 0, product = period / 4, radius = 1e30;
    std::size_t rest = i;
    for (int a = 0; a < Dim; ++a) {
      const double x = static_cast<double>(rest % size[a]), half = static_cast<double>(size[a]) / 2;
      squares += (x - half) * (x - half);
      radius = std::min(radius, half / 2);
      product *= std::sin(2 * std::numbers::pi * x / period);
      rest /= size[a];
    }
    start->GetBufferPointer()[i] = static_cast<float>(parameters.balls ? product : std::sqrt(squares) - radius);
  }

  const auto step = itk::AtanRegularizedHeavisideStepFunction<float, float>::New();
  step->SetEpsilon(5);
  const auto filter = Filter::New();
  filter->SetFunctionCount(1);
  filter->SetFeatureImage(feature);
  filter->SetLevelSet(0, start);
  filter->SetNumberOfIterations(200);
  filter->SetMaximumRMSError(1e-3);
  filter->SetUseImageSpacing(1);
  filter->SetInPlace(false);
  const auto speed = filter->GetDifferenceFunction(0);
  speed->SetDomainFunction(step);
  speed->SetCurvatureWeight(parameters.curvature);
  speed->SetAreaWeight(0);
  speed->SetReinitializationSmoothingWeight(0);
  speed->SetVolumeMatchingWeight(0);
  speed->SetLambda1(1);
  speed->SetLambda2(1);
  filter->Update();
  csrbf::Volume<float> labels{csrbf::VolumeLayout(given)};
  // The output holds the numbers of the functions that are negative.
  const float* values = filter->GetOutput()->GetBufferPointer();
  for (std::size_t i = 0; i < labels.values.size(); ++i) labels.values[i] = values[i] > 0 ? 1 : 0;
  cost.write(parameters.cost_file);
  std::cerr << filter->GetElapsedIterations() << " iterations, change " << filter->GetRMSChange() << '\n';
  return labels;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 6) {
    std::cerr << "usage: itk_chan_vese IMAGE.npy LABELS.npy COST.json (ball|balls) CURVATURE\n";
    return 2;
  }
  const csrbf::Volume<float> image = csrbf::read_volume<float>(arguments[1]);
  const Parameters parameters{std::string(arguments[4]) == "balls", std::stod(arguments[5]), arguments[3]};
  const auto labels = image.grid.axes == 3 ? segment<3>(image, parameters) : segment<2>(image, parameters);
  csrbf::write_volume(arguments[2], labels);
  return 0;
} catch (const std::exception& error) {
  std::cerr << "itk_chan_vese: " << error.what() << '\n';
  return 1;
}
