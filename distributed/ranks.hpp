#pragma once

#include "agreement.hpp"
#include "process/processes.hpp"
#include "shares.hpp"

#include <span>
#include <string>
#include <vector>

namespace csrbf::distributed {

/// The ranks of a communicator as the processes of the program: the first reads and writes, all share the work.
class Ranks : public app::Processes, public WorkSharing {
 public:
  explicit Ranks(MPI_Comm comm);

  [[nodiscard]] Agreement& agreement() { return agreement_; }

  /// The cores of a node divided among its ranks, or those that this rank is bound to.
  [[nodiscard]] int threads() const override;
  bool interrupted() override;
  void conclude(const std::function<void()>& work) override;
  void describe(nlohmann::ordered_json& report) const override;

  /// Every rank computes its blocks and sends the results to all others.
  void share(const SharedWork& work) override;

  /// The content of a file, which the first rank reads.
  std::string read(const std::string& path);

 private:
  // What the ranks send in one round.
  struct Round {
    std::vector<std::int64_t> blocks;  // of each rank
    std::vector<int> bytes, begin;     // of each rank in `received`
    std::vector<std::byte> received;
  };

  void exchange(std::span<const std::byte> mine, std::int64_t blocks, Round& round);
  void unpack(const SharedWork& work, const Round& round, std::vector<Index>& next) const;

  MPI_Comm comm_;
  Agreement agreement_;
  TrafficTable traffic_;
  double waiting_ = 0;  // CPU seconds inside MPI, which polls for the others
};

}  // namespace csrbf::distributed
