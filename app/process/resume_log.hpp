#pragma once

#include "csrbf/core/shared_work.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace csrbf::app {

/// A hash of the content of a file. Throws IoError when it cannot be read.
std::uint64_t fingerprint(const std::string& path);

/// Saves the results of the expensive steps of a computation to a file as they become available, so that a later run
/// of the same computation can reuse them. The file has a header with the key of the computation, then records:
/// results of some blocks of a step, in the order of the steps. Every record has a checksum; what follows the last
/// valid one is dropped. Results that are computed about as fast as they are read are not saved.
///
/// Each record is written at once, so it survives a killed process; when it reaches the disk is up to the system.
class ResumeLog : public WorkSharing {
 public:
  /// Opens or creates the log, and handles the shared work of this process from now on. `key`: lines that determine the
  /// results. Throws UsageError when the log has another key or is in use, IoError when it cannot be written.
  ResumeLog(const std::string& path, const std::string& key);
  ~ResumeLog() override;

  void share(const SharedWork& work) override;

  /// After success: the file is not needed any more.
  void remove() const;

  struct Use {
    std::size_t taken_bytes = 0, written_bytes = 0;
    double seconds_saved = 0;  ///< that the reused results took to compute
    int error = 0;             ///< of the system, after which nothing is written; 0: none
  };
  [[nodiscard]] const Use& use() const { return use_; }

 private:
  struct Head {
    std::uint64_t work, kind;  // number of the step; hash that identifies it
    Index first, last;         // blocks
    double seconds;            // to compute them
    std::uint64_t size, checksum;
  };
  struct Record {
    Head head;
    std::vector<std::byte> results;
  };

  void read_header(const std::string& key);
  [[nodiscard]] std::optional<Record> read_record();
  void take_over(const SharedWork& work, const Record& record);
  void compute_and_keep(const SharedWork& work, std::uint64_t kind, Index first);
  void append(Head head, std::span<const std::byte> results);

  std::string path_;
  int file_;
  std::int64_t end_ = 0;          // of what was read or written so far
  std::optional<Record> record_;  // the next one of the log
  std::uint64_t works_ = 0;       // so far
  Use use_;
};

}  // namespace csrbf::app
