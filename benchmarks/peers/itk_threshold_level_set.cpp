// ITK's level set between two thresholds, to compare csrbf with.
// usage: itk_threshold_level_set IMAGE START LABELS COST.json NX NY NZ LOWER UPPER CURVATURE
// Files hold 32-bit floating-point numbers, x fastest: ITK has an Eigen of its own, beside which csrbf's does not
// compile. START: negative inside, about the signed distance. NZ is 1 in the plane.

#include "cost.hpp"

#include <itkImage.h>
#include <itkThresholdSegmentationLevelSetImageFilter.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

struct Parameters {
  std::vector<std::size_t> size;
  float lower, upper;
  float curvature;  // weight, beside 1 for the speed
};

std::vector<float> read(const std::string& path, std::size_t count) {
  std::vector<float> values(count);
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(float))))
    throw std::runtime_error(path + ": cannot read as many numbers as there are voxels");
  return values;
}

template <int Dim>
std::vector<float> segment(const std::vector<float>& given, const std::vector<float>& start,
                           const Parameters& parameters) {
  using Image = itk::Image<float, Dim>;
  typename Image::SizeType size;
  typename Image::RegionType region;
  std::copy_n(parameters.size.begin(), Dim, size.begin());
  region.SetSize(size);
  const auto copy_of = [&region](const std::vector<float>& values) {
    const auto image = Image::New();
    image->SetRegions(region);
    image->Allocate();
    std::copy(values.begin(), values.end(), image->GetBufferPointer());
    return image;
  };
  const auto filter = itk::ThresholdSegmentationLevelSetImageFilter<Image, Image>::New();
  const auto feature = copy_of(given), level_set = copy_of(start);
  filter->SetInput(level_set);
  filter->SetFeatureImage(feature);
  filter->SetLowerThreshold(parameters.lower);
  filter->SetUpperThreshold(parameters.upper);
  filter->SetCurvatureScaling(parameters.curvature);
  filter->SetPropagationScaling(1);
  filter->SetIsoSurfaceValue(0);
  filter->SetMaximumRMSError(1e-3);
  filter->SetNumberOfIterations(3000);
  filter->Update();
  std::cerr << filter->GetElapsedIterations() << " iterations, change " << filter->GetRMSChange() << '\n';
  const float* values = filter->GetOutput()->GetBufferPointer();
  std::vector<float> labels(given.size());
  std::transform(values, values + labels.size(), labels.begin(), [](float f) { return f < 0 ? 1.0F : 0.0F; });
  return labels;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 11) {
    std::cerr << "usage: itk_threshold_level_set IMAGE START LABELS COST.json NX NY NZ LOWER UPPER CURVATURE\n";
    return 2;
  }
  Parameters parameters{{}, std::stof(arguments[8]), std::stof(arguments[9]), std::stof(arguments[10])};
  std::size_t voxels = 1;
  for (int a = 5; a < 8; ++a) {
    parameters.size.push_back(std::stoul(arguments[a]));
    voxels *= parameters.size.back();
  }
  const std::vector<float> image = read(arguments[1], voxels), start = read(arguments[2], voxels);
  const Cost cost;
  const std::vector<float> labels =
      parameters.size[2] > 1 ? segment<3>(image, start, parameters) : segment<2>(image, start, parameters);
  cost.write(arguments[4]);
  std::ofstream file(arguments[3], std::ios::binary);
  file.write(reinterpret_cast<const char*>(labels.data()), static_cast<std::streamsize>(voxels * sizeof(float)));
  if (!file) throw std::runtime_error(std::string(arguments[3]) + ": cannot write");
  return 0;
} catch (const std::exception& error) {
  std::cerr << "itk_threshold_level_set: " << error.what() << '\n';
  return 1;
}
