#pragma once

#include "csrbf/approx/samples/samples.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/samples.hpp"
#include "csrbf/tiles/stages/deal_records.hpp"

#include <optional>

namespace csrbf {

/// Reads the samples of a file piece by piece, in their order, in little memory: .npy arrays in C order. All other
/// formats of read_samples() are read whole.
class SampleStream {
 public:
  /// Rows whose values are all `missing` have none. Throws IoError as read_samples().
  SampleStream(std::string path, SampleColumns columns, std::optional<double> missing);

  /// Rows in the file.
  [[nodiscard]] Index size() const { return size_; }
  /// The first of them: names, and numbers of columns.
  [[nodiscard]] const SampleTable& head() const { return head_; }
  /// Coordinates, values and, if there are any, weights of the rows [begin, end), coordinates divided by `scales`. Rows
  /// without a value have infinity as coordinates, those that lack a number NaN.
  template <int Dim>
  [[nodiscard]] Records<Dim> read(Index begin, Index end, const Point<Dim>& scales);

 private:
  [[nodiscard]] bool open_npy();
  [[nodiscard]] SampleTable table(Index begin, Index end);

  std::string path_;
  SampleColumns columns_;
  std::optional<double> missing_;
  Index size_ = 0;
  OpenFile file_;  // null where the file is read whole
  std::size_t data_begin_ = 0, row_size_ = 0;
  std::string header_;  // of a file of no rows
  SampleTable head_;
  SampleTable all_;
};

/// Samples from records.
template <int Dim>
Samples<Dim> samples_of(const Records<Dim>& records, bool weights);

}  // namespace csrbf
