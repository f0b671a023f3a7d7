#include "csrbf/tiles/stages/sample_stream.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/files/read_file.hpp"

#include <cstring>
#include <filesystem>
#include <limits>

namespace csrbf {
namespace {

constexpr std::size_t longest_npy_header = 1 << 16;  // bytes; files with longer ones are read whole

// With the rows that lack a number, which get NaN for coordinates.
SampleTable with_all_rows(SampleTable part) {
  if (part.dropped == 0) return part;
  const Index n = part.coordinates.cols() + part.dropped;
  Eigen::MatrixXd coordinates =
      Eigen::MatrixXd::Constant(part.coordinates.rows(), n, std::numeric_limits<double>::quiet_NaN());
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(n, part.values.cols());
  coordinates(Eigen::all, part.rows) = part.coordinates;
  values(part.rows, Eigen::all) = part.values;
  part.coordinates = std::move(coordinates);
  part.values = std::move(values);
  if (part.weights.size() > 0) {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(n);
    weights(part.rows) = part.weights;
    part.weights = std::move(weights);
  }
  return part;
}

}  // namespace

SampleStream::SampleStream(std::string path, SampleColumns columns, std::optional<double> missing)
    : path_(std::move(path)), columns_(std::move(columns)), missing_(missing) {
  if (file_extension(path_) == ".npy" && open_npy()) {
    head_ = table(0, std::min<Index>(1, size_));
    return;
  }
  file_.reset();
  all_ = with_all_rows(read_samples(path_, columns_));
  size_ = all_.coordinates.cols();
  head_ = table(0, 1);
}

bool SampleStream::open_npy() {
  file_.reset(open_file(path_, "rb"));
  if (file_ == nullptr) return false;
  std::string start(longest_npy_header, '\0');
  start.resize(std::fread(start.data(), 1, start.size(), file_.get()));
  std::string_view rest = start;
  const NpyHeader header = parse_npy_header(rest, path_);
  if (header.shape.size() != 2 || header.shape[0] == 0 || header.fortran || header.order != std::endian::little)
    return false;
  data_begin_ = start.size() - rest.size();
  row_size_ = sample_size(header.type) * static_cast<std::size_t>(header.shape[1]);
  size_ = header.shape[0];
  header_ = format_npy_header(header.type, {0, header.shape[1]});
  return std::filesystem::file_size(utf8_path(path_)) >= data_begin_ + row_size_ * static_cast<std::size_t>(size_);
}

// Rows that lack a number stay, with NaN.
SampleTable SampleStream::table(Index begin, Index end) {
  const Index n = end - begin;
  SampleTable part;
  if (file_ == nullptr) {
    part.coordinates = all_.coordinates.middleCols(begin, n);
    part.values = all_.values.middleRows(begin, n);
    if (all_.weights.size() > 0) part.weights = all_.weights.segment(begin, n);
    part.coordinate_names = all_.coordinate_names;
    part.value_names = all_.value_names;
    part.crs = all_.crs;
    part.left_out = all_.left_out;
    part.suspicion = all_.suspicion;
    part.misplaced = all_.misplaced;
    part.deviation = all_.deviation;
    return part;
  }
  std::string_view none = header_;
  const NpyHeader header = parse_npy_header(none, path_);
  std::string bytes = format_npy_header(header.type, {n, header.shape[1]});
  const std::size_t before = bytes.size(), wanted = row_size_ * static_cast<std::size_t>(n);
  bytes.resize(before + wanted);
  const std::size_t at = data_begin_ + row_size_ * static_cast<std::size_t>(begin);
  if (!seek_file(file_.get(), static_cast<std::int64_t>(at), SEEK_SET) ||
      std::fread(bytes.data() + before, 1, wanted, file_.get()) != wanted)
    throw IoError(path_ + ": the file ends before row " + std::to_string(end));
  return with_all_rows(parse_npy_samples(bytes, path_, columns_));
}

template <int Dim>
Records<Dim> SampleStream::read(Index begin, Index end, const Point<Dim>& scales) {
  const SampleTable part = table(begin, end);
  const Index n = part.coordinates.cols(), k = part.values.cols();
  const bool weighted = part.weights.size() > 0;
  Records<Dim> records;
  records.each = sizeof(double) * static_cast<std::size_t>(k + (weighted ? 1 : 0));
  std::vector<double> payload(static_cast<std::size_t>(k + (weighted ? 1 : 0)));
  const auto add = [&](const Point<Dim>& point) {
    records.add(point, {reinterpret_cast<const char*>(payload.data()), records.each});
  };
  const Point<Dim> elsewhere = Point<Dim>::Constant(std::numeric_limits<double>::infinity());
  for (Index i = 0; i < n; ++i) {
    for (Index c = 0; c < k; ++c) payload[static_cast<std::size_t>(c)] = part.values(i, c);
    if (weighted) payload.back() = part.weights[i];
    const bool has_value = !missing_ || (part.values.row(i).array() != *missing_).any();
    add(has_value ? Point<Dim>(part.coordinates.col(i).cwiseQuotient(scales)) : elsewhere);
  }
  return records;
}

template <int Dim>
Samples<Dim> samples_of(const Records<Dim>& records, bool weights) {
  const Index n = records.size(), columns = static_cast<Index>(records.each / sizeof(double));
  const Index k = columns - (weights ? 1 : 0);
  Eigen::MatrixXd numbers(columns, n);
  if (n > 0) std::memcpy(numbers.data(), records.payload.data(), records.payload.size());
  Samples<Dim> samples;
  samples.points = records.matrix();
  samples.values = numbers.topRows(k).transpose();
  if (weights) samples.weights = numbers.row(k).transpose();
  return samples;
}

#define CSRBF_INSTANTIATE(Dim)                                                    \
  template Records<Dim> SampleStream::read<Dim>(Index, Index, const Point<Dim>&); \
  template Samples<Dim> samples_of<Dim>(const Records<Dim>&, bool);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
