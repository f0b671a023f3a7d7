#pragma once

#include "csrbf/io/images/sample_codec.hpp"
#include "csrbf/io/vtk/xml.hpp"

namespace csrbf {

/// An array of a VTK file: `components` per point, voxel or corner.
struct VtkArray {
  std::string name;
  SampleType type = SampleType::float32;
  Index components = 1;
  std::string bytes = {};  ///< little-endian
};

/// Values as bytes of the type: integers are rounded and clamped, NaN becomes 0.
std::string vtk_bytes(SampleType type, const Eigen::Ref<const Eigen::MatrixXd>& values);

/// Writes a VTK XML file: arrays are declared in the text and appended to it, raw.
class VtkWriter {
 public:
  /// The tag of an array, whose bytes are kept for the end.
  std::string array(VtkArray array);

  /// The file: `type` is that of the data set, such as ImageData; `content` its element.
  [[nodiscard]] FileParts file(std::string_view type, const std::string& content) const;

 private:
  std::string data_;
};

/// Reads a VTK XML file: data as text, base64 or raw, inline or appended, with and without zlib.
class VtkReader {
 public:
  /// `bytes` must outlive the reader. Throws IoError for other files, kinds of data sets than `type` and compressors.
  VtkReader(std::string_view bytes, std::string_view type, const std::string& name);
  VtkReader(const VtkReader&) = delete;
  VtkReader& operator=(const VtkReader&) = delete;

  /// The element of the data set, and its only piece.
  [[nodiscard]] const XmlElement& data_set() const { return *data_set_; }
  [[nodiscard]] const XmlElement& piece() const { return *piece_; }

  /// An attribute as a whole number from 0 on. Throws IoError.
  [[nodiscard]] Index count(const XmlElement& element, std::string_view attribute) const;
  /// An attribute as that many numbers; nothing when it is missing. Throws IoError.
  [[nodiscard]] std::optional<Eigen::VectorXd> numbers(const XmlElement& element, std::string_view attribute,
                                                       Index expected) const;

  [[nodiscard]] SampleType type(const XmlElement& array) const;
  [[nodiscard]] Index components(const XmlElement& array) const;
  [[nodiscard]] std::endian order() const { return order_; }

  /// The bytes of an array of that many tuples, in order(). Throws IoError; when the file cannot hold them, before
  /// memory is allocated.
  [[nodiscard]] std::string bytes(const XmlElement& array, Index tuples) const;
  /// The same as numbers, components x tuples.
  [[nodiscard]] Eigen::MatrixXd values(const XmlElement& array, Index tuples) const;

  [[noreturn]] void fail(const std::string& what) const;

 private:
  [[nodiscard]] std::string ascii(const XmlElement& array, std::size_t samples) const;

  std::string name_;
  XmlElement root_;
  const XmlElement* data_set_ = nullptr;
  const XmlElement* piece_ = nullptr;
  std::string_view appended_;
  bool appended_is_base64_ = false;
  bool compressed_ = false;
  std::size_t header_size_ = 4;
  std::endian order_ = std::endian::little;
};

}  // namespace csrbf
