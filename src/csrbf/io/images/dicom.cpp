#include "csrbf/io/images/dicom.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/joined.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/images/dicom_structure.hpp"

#include <filesystem>
#include <fstream>

#ifdef CSRBF_HAS_GDCM
#include "csrbf/io/images/dicom_slice.hpp"

#include <map>
#endif

namespace csrbf {

bool is_dicom(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error) || file_extension(path) == ".dcm") return true;
  if (!std::filesystem::is_regular_file(path, error)) return false;  // reading from a pipe would take its bytes
  std::array<char, 132> start{};
  std::ifstream file(std::filesystem::path(path), std::ios::binary);
  file.read(start.data(), start.size());
  return file && dicom::has_preamble({start.data(), start.size()});
}

#ifndef CSRBF_HAS_GDCM

bool reads_dicom() {
  return false;
}

RawVolume read_dicom(const std::string& path) {
  throw IoError(path +
                ": DICOM files cannot be read: this program was built without GDCM; install it (libgdcm-dev) and " +
                "build again, or convert to .nii.gz");
}

#else

namespace {

using dicom::Slice;

// Tolerances for the rounding of header fields, which are decimal texts; chosen by hand.
constexpr double same_direction = 1e-4;  // of unit vectors
constexpr double same_length = 1e-4;     // of the spacing
constexpr double most_off_line = 0.01;   // of the distance between slices

// The slices of a folder, ordered by file name.
std::vector<Slice> slices_in(const std::string& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file()) paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  std::vector<Slice> slices;
  for (const std::string& path : paths)
    if (std::optional<Slice> slice = dicom::read_header(path)) slices.push_back(std::move(*slice));
  if (slices.empty()) throw IoError(folder + ": the folder holds no DICOM image");
  return slices;
}

void check_one_series(const std::vector<Slice>& slices, const std::string& folder) {
  std::map<std::string, std::pair<std::string, int> > series;
  for (const Slice& slice : slices) {
    auto& [description, files] = series[slice.series];
    description = slice.description;
    ++files;
  }
  if (series.size() < 2) return;
  std::vector<std::string> list;
  for (const auto& [uid, value] : series)
    list.push_back((value.first.empty() ? "" : value.first + " = ") + uid + " (" + std::to_string(value.second) +
                   (value.second == 1 ? " file)" : " files)"));
  throw IoError(folder + ": the folder holds images of " + std::to_string(series.size()) + " series: " + joined(list) +
                "; move each to a folder of its own");
}

// Orders slices by their position along the normal of the first.
void sort_slices(std::vector<Slice>& slices) {
  for (const Slice& slice : slices) {
    if (!slice.placed)
      throw IoError(slice.path + ": the image has no position, so its place among the slices is unknown");
    if ((slice.axes - slices[0].axes).cwiseAbs().maxCoeff() > same_direction)
      throw IoError(slice.path + ": the slice is not parallel to " + slices[0].path);
  }
  const Point<3> normal = slices[0].normal();
  std::stable_sort(slices.begin(), slices.end(),
                   [&](const Slice& a, const Slice& b) { return a.origin.dot(normal) < b.origin.dot(normal); });
}

// The step from slice to slice.
Point<3> even_step(const std::vector<Slice>& slices) {
  const auto steps = static_cast<double>(slices.size() - 1);
  const Point<3> step = (slices.back().origin - slices.front().origin) / steps;
  const double thickness = std::abs(step.dot(slices[0].normal()));
  for (std::size_t i = 1; i < slices.size(); ++i)
    if ((slices[i].origin - slices[i - 1].origin).norm() <= most_off_line * thickness)
      throw IoError(slices[i].path + ": the slice has the same position as " + slices[i - 1].path +
                    "; sequences of volumes are not supported: move each to a folder of its own");
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const double off = (slices[i].origin - slices[0].origin - static_cast<double>(i) * step).norm();
    if (!(off <= most_off_line * thickness))
      throw IoError(slices[i].path + ": slice " + std::to_string(i + 1) + " of " + std::to_string(slices.size()) +
                    " is " + std::to_string(off) + " mm from where even distances of " + std::to_string(thickness) +
                    " mm would put it; is a slice missing?");
  }
  return step;
}

void check_alike(const dicom::Image& image, const dicom::Image& first, const std::string& path,
                 const std::string& first_path) {
  const auto check = [&](bool holds, const char* what) {
    if (!holds) throw IoError(path + ": the " + what + " differs from that of " + first_path);
  };
  check(image.size == first.size, "size of the image");
  check(image.type == first.type, "type of the samples");
  check((image.spacing - first.spacing).cwiseAbs().maxCoeff() <= same_length * first.spacing.minCoeff(), "spacing");
}

// The values of slices whose scales differ.
template <class T>
void append_values(const dicom::Image& image, std::string& bytes) {
  for (std::size_t i = 0; i < image.samples.size(); i += sizeof(T)) {
    T sample;
    std::copy_n(image.samples.data() + i, sizeof(T), reinterpret_cast<char*>(&sample));
    const auto value = static_cast<float>(image.slope * static_cast<double>(sample) + image.intercept);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
}

// Reads the samples of all slices, one after the other.
RawVolume read_slices(const std::vector<Slice>& slices) {
  RawVolume raw;
  dicom::Image first;
  bool one_scale = true;
  std::vector<dicom::Image> images;
  for (const Slice& slice : slices) {
    dicom::Image image = dicom::read_image(slice.path);
    if (images.empty()) first = image;
    check_alike(image, first, slice.path, slices[0].path);
    if (slices.size() > 1 && image.size[2] > 1)
      throw IoError(slice.path + ": the file holds several frames; move it to a folder of its own");
    one_scale = one_scale && image.slope == first.slope && image.intercept == first.intercept;
    images.push_back(std::move(image));
  }
  raw.layout.type = one_scale ? first.type : SampleType::float32;
  raw.slope = one_scale ? first.slope : 1;
  raw.intercept = one_scale ? first.intercept : 0;
  raw.bytes.reserve(images.size() * first.samples.size() / sample_size(first.type) * sample_size(raw.layout.type));
  for (dicom::Image& image : images) {
    if (one_scale)
      raw.bytes += image.samples;
    else
      with_sample_type(first.type, [&](auto sample) { append_values<decltype(sample)>(image, raw.bytes); });
    image.samples = {};
  }
  Grid& grid = raw.layout.grid;
  grid.size = {first.size[0], first.size[1], slices.size() > 1 ? static_cast<Index>(slices.size()) : first.size[2]};
  grid.spacing = first.spacing;
  if (first.is_sequence) {
    raw.layout.frames = grid.size[2];
    raw.layout.time_step = first.time_step;
    grid.size[2] = 1;
  }
  grid.axes = grid.size[2] > 1 ? 3 : 2;
  return raw;
}

}  // namespace

bool reads_dicom() {
  return true;
}

RawVolume read_dicom(const std::string& path) {
  std::vector<Slice> slices;
  if (std::filesystem::is_directory(path)) {
    slices = slices_in(path);
    check_one_series(slices, path);
  } else if (std::optional<Slice> slice = dicom::read_header(path)) {
    slices.push_back(std::move(*slice));
  } else {
    throw IoError(path + ": not a DICOM file, or one without an image");
  }
  if (slices.size() > 1) sort_slices(slices);
  const Point<3> step = slices.size() > 1 ? even_step(slices) : slices[0].normal();
  RawVolume raw = read_slices(slices);
  Grid& grid = raw.layout.grid;
  if (!slices[0].placed) return raw;
  const double distance = slices.size() > 1 ? 1 : grid.spacing[2];
  Eigen::Matrix3d linear;
  linear << slices[0].axes * grid.spacing.head<2>().asDiagonal(), distance * step;
  grid.origin = slices[0].origin;
  grid.space = Space::left_posterior_superior;
  set_axes(grid, linear, path);
  return raw;
}

#endif

}  // namespace csrbf
