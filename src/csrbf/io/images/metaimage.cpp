#include "csrbf/io/images/formats.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/io/images/raw_data.hpp"

namespace csrbf {
namespace {

using enum SampleType;
constexpr TypeName element_types[] = {
    {"MET_UCHAR", uint8},   {"MET_CHAR", int8},      {"MET_USHORT", uint16},     {"MET_SHORT", int16},
    {"MET_UINT", uint32},   {"MET_INT", int32},      {"MET_ULONG_LONG", uint64}, {"MET_LONG_LONG", int64},
    {"MET_FLOAT", float32}, {"MET_DOUBLE", float64}, {"MET_ULONG", uint32},      {"MET_LONG", int32},
};

constexpr std::size_t most_axes = 4;  // three in space and time

class HeaderParser {
 public:
  HeaderParser(std::string_view text, const std::string& path)
      : reader_(text, display_name(path)), size_(text.size()) {}

  // Fills in the layout and the location of the samples.
  RawData parse(RawVolume& raw) {
    while (!done_) {
      if (!reader_.next()) throw IoError(reader_.name() + ": the header ends without ElementDataFile");
      read_field(raw);
    }
    if (lengths_.empty()) throw IoError(reader_.name() + ": the header has no DimSize");
    if (!type_) throw IoError(reader_.name() + ": the header has no ElementType");
    raw.layout.type = *type_;
    set_layout(raw.layout);
    data_.begin = size_ - reader_.rest().size();
    return data_;
  }

 private:
  void read_field(RawVolume& raw) {
    const std::string_view line = reader_.line();
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) reader_.fail("expected \"name = value\", found " + in_quotes(line));
    const std::string_view key = trimmed(line.substr(0, equals));
    const std::string_view value = trimmed(line.substr(equals + 1));
    const bool yes = value.starts_with('T') || value.starts_with('t') || value == "1";
    if (key == "NDims") {
      if (axes_ != 0) reader_.fail("NDims appears twice");
      axes_ = reader_.integer(value, 1, most_axes);
    } else if (key == "DimSize") {
      for (const double length : numbers(value, axes_)) lengths_.push_back(checked_length(length));
    } else if (key == "ElementSpacing" || (key == "ElementSize" && spacing_.empty())) {
      spacing_ = numbers(value, axes_);
    } else if (key == "Offset" || key == "Origin" || key == "Position") {
      offset_ = numbers(value, axes_);
    } else if (key == "TransformMatrix" || key == "Rotation" || key == "Orientation") {
      matrix_ = numbers(value, axes_ * axes_);
    } else if (key == "ElementNumberOfChannels") {
      raw.layout.components = reader_.integer(value, 1, 1 << 16);
    } else if (key == "BinaryData") {
      if (!yes) data_.encoding = RawData::Encoding::ascii;
    } else if (key == "CompressedData") {
      if (yes) data_.encoding = RawData::Encoding::deflate;
    } else if (key == "BinaryDataByteOrderMSB" || key == "ElementByteOrderMSB") {
      raw.order = yes ? std::endian::big : std::endian::little;
    } else if (key == "HeaderSize") {
      data_.skip_bytes = reader_.integer(value, -1, std::numeric_limits<std::int64_t>::max());
    } else if (key == "ElementType") {
      type_ = type_named(value, element_types);
      if (!type_)
        reader_.fail("samples of type " + in_quotes(value) + " are not supported; MET_UCHAR to MET_DOUBLE are");
    } else if (key == "ElementDataFile") {
      if (value.starts_with("LIST") || value.find('%') != std::string_view::npos || value.empty())
        reader_.fail("images in several files are not supported, found " + in_quotes(value));
      if (value != "LOCAL" && value != "Local" && value != "local") data_.file = value;
      done_ = true;  // the samples may follow
    }
  }

  Index checked_length(double length) {
    constexpr double longest = 1e12;
    if (!(length >= 1 && length <= longest) || length != std::floor(length))
      reader_.fail("the sizes of the axes must be positive whole numbers");
    return static_cast<Index>(length);
  }

  std::vector<double> numbers(std::string_view value, std::size_t count) {
    if (axes_ == 0) reader_.fail("NDims must come before this field");
    std::vector<double> found;
    for (std::string_view word = take_word(value); !word.empty(); word = take_word(value))
      found.push_back(reader_.number(word));
    if (found.size() != count)
      reader_.fail("expected " + std::to_string(count) + " numbers, found " + std::to_string(found.size()));
    return found;
  }

  // The fourth axis is time; rows of the matrix are the directions of the axes.
  void set_layout(VolumeLayout& layout) const {
    const int axes = std::min(static_cast<int>(axes_), 3);
    Grid& grid = layout.grid;
    grid.axes = axes;
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
    for (int i = 0; i < axes; ++i) {
      grid.size[i] = lengths_[i];
      if (!offset_.empty()) grid.origin(i) = offset_[i];
      for (int j = 0; j < axes && !matrix_.empty(); ++j) linear(j, i) = matrix_[i * axes_ + j];
      if (!spacing_.empty()) linear.col(i) *= std::abs(spacing_[i]);
    }
    set_axes(grid, linear, reader_.name());
    grid.space = Space::left_posterior_superior;
    if (axes_ < most_axes) return;
    layout.frames = lengths_[3];
    if (!spacing_.empty()) layout.time_step = spacing_[3];
  }

  LineReader reader_;
  std::size_t size_;
  bool done_ = false;
  std::optional<SampleType> type_;
  std::size_t axes_ = 0;
  std::vector<Index> lengths_;
  std::vector<double> spacing_, offset_, matrix_;
  RawData data_;
};

}  // namespace

RawVolume parse_metaimage(std::string bytes, const std::string& path) {
  RawVolume raw;
  raw.order = std::endian::little;
  const RawData data = HeaderParser(bytes, path).parse(raw);
  load_raw_data(raw, data, std::move(bytes), path);
  return raw;
}

FileParts format_metaimage(const VolumeLayout& layout, std::string samples, const std::string& data_file) {
  const Grid grid = in_space(layout.grid, Space::left_posterior_superior);
  const int space_axes = layout.frames > 1 ? 3 : grid.axes;
  const int axes = layout.frames > 1 ? 4 : grid.axes;
  std::string size, spacing, origin, matrix;
  const auto add = [](std::string& list, double value) {
    list += ' ';
    append_number(list, value);
  };
  for (int i = 0; i < axes; ++i) {
    const bool time = i == 3;
    size += " " + std::to_string(time ? layout.frames : grid.size[i]);
    add(spacing, time ? layout.time_step : grid.spacing(i));
    add(origin, time ? 0 : grid.origin(i));
    for (int j = 0; j < axes; ++j)
      add(matrix, i < space_axes && j < space_axes ? grid.direction(j, i) : (i == j ? 1 : 0));
  }
  std::string head =
      "ObjectType = Image\nNDims = " + std::to_string(axes) +
      "\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\nTransformMatrix =" + matrix +
      "\nOffset =" + origin + "\nElementSpacing =" + spacing + "\nDimSize =" + size + "\n";
  if (layout.components > 1) head += "ElementNumberOfChannels = " + std::to_string(layout.components) + "\n";
  head += "ElementType = " + std::string(name_of(layout.type, element_types)) + "\n";
  return {head + "ElementDataFile = " + data_file + "\n", std::move(samples)};
}

}  // namespace csrbf
