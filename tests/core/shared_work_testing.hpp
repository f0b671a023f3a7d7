#pragma once

#include "csrbf/core/shared_work.hpp"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace csrbf {

/// Stands for one of several processes: it computes every `ranks`-th block and takes the others from a record that an
/// earlier run of the same computation left. Sets itself as the WorkSharing for as long as it lives.
class PretendRank : public WorkSharing {
 public:
  /// Results of blocks, by the number of the work and of the block.
  using Record = std::map<std::pair<Index, Index>, std::vector<std::byte>>;

  /// Computes and records all blocks.
  explicit PretendRank(Record& record) : record_(record) { set_work_sharing(this); }
  /// Computes its own blocks only.
  PretendRank(Record& record, Index rank, Index ranks) : record_(record), rank_(rank), ranks_(ranks) {
    set_work_sharing(this);
  }
  ~PretendRank() override { set_work_sharing(nullptr); }

  void share(const SharedWork& work) override {
    const Index number = works_++;
    names_[std::string(work.name)] += work.items;
    for (Index b = 0; b < work.blocks(); ++b)
      if (b % ranks_ == rank_) work.compute_blocks(b, b + 1);
    for (Index b = 0; b < work.blocks(); ++b) {
      std::vector<std::byte>& bytes = record_[{number, b}];
      if (ranks_ == 1) {
        ByteWriter out;
        work.pack(work.begin(b), work.end(b), out);
        bytes.assign(out.bytes().begin(), out.bytes().end());
      } else if (b % ranks_ != rank_) {
        ByteReader in(bytes);
        work.unpack(work.begin(b), work.end(b), in);
        left_over_ += in.left();
      }
    }
  }

  [[nodiscard]] Index works() const { return works_; }
  /// Items shared, by the name of the work.
  [[nodiscard]] const std::map<std::string, Index>& names() const { return names_; }
  /// Bytes that were written but not taken.
  [[nodiscard]] std::size_t left_over() const { return left_over_; }

 private:
  Record& record_;
  Index rank_ = 0, ranks_ = 1;
  Index works_ = 0;
  std::map<std::string, Index> names_;
  std::size_t left_over_ = 0;
};

/// Runs `compute` alone, then as each of `ranks` processes; `check(result alone, result of a rank)` compares. Returns
/// the items shared, by the name of the work.
template <class Compute, class Check>
std::map<std::string, Index> compare_with_ranks(Index ranks, const Compute& compute, const Check& check) {
  const auto alone = compute();
  PretendRank::Record record;
  Index works = 0;
  {
    const PretendRank everything(record);
    check(alone, compute());
    works = everything.works();
  }
  std::map<std::string, Index> names;
  for (Index rank = 0; rank < ranks; ++rank) {
    const PretendRank one(record, rank, ranks);
    check(alone, compute());
    if (one.works() != works || one.left_over() != 0) throw std::logic_error("the ranks do not go in step");
    names = one.names();
  }
  return names;
}

}  // namespace csrbf
