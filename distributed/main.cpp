#include "mumps_factor.hpp"
#include "pretended_ranks.hpp"
#include "program.hpp"
#include "ranks.hpp"
#include "traffic_report.hpp"

#include "csrbf/io/files/process_files.hpp"
#include "csrbf/io/files/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

// csrbf-mpi: the program csrbf on the ranks of MPI. `csrbf-mpi --pretend-ranks N COMMAND ...`, on one rank, computes
// everything itself and reports what each of N ranks would exchange.

namespace csrbf::distributed {
namespace {

constexpr int bad_usage = 2;
constexpr const char* pretend_flag = "--pretend-ranks";

// What one process reports about pretended ranks.
class PretendingProcess : public app::Processes {
 public:
  explicit PretendingProcess(const PretendedRanks& ranks) : ranks_(ranks) {}

  void describe(nlohmann::ordered_json& report) const override {
    report["ranks"] = 1;
    report["pretended_ranks"] = ranks_.traffic().size();
    for (const TrafficTable& traffic : ranks_.traffic()) report["shared_work"].push_back(to_json(traffic));
  }

 private:
  const PretendedRanks& ranks_;
};

int fail(const char* message) {
  std::fprintf(stderr, "csrbf-mpi: %s\n", message);
  return bad_usage;
}

int pretend(int argc, char** argv) {
  constexpr int most = 100000;  // more is a typing error
  const auto ranks = argc > 2 ? parse_number(argv[2]) : std::nullopt;
  if (!ranks || *ranks < 1 || *ranks > most || *ranks != std::floor(*ranks))
    return fail("--pretend-ranks needs a number of ranks between 1 and 100000");
  PretendedRanks sharing(static_cast<int>(*ranks));
  PretendingProcess process(sharing);
  set_work_sharing(&sharing);
  app::set_processes(&process);
  argv[2] = argv[0];
  return app::run_program(argc - 2, argv + 2);
}

int run_on_ranks(int argc, char** argv) {
  Ranks ranks(MPI_COMM_WORLD);
  const bool several = ranks.agreement().size() > 1;
  // The other ranks print nothing: the first one is told of their failures.
  if (ranks.agreement().rank() > 0 &&
      (std::freopen("/dev/null", "w", stdout) == nullptr || std::freopen("/dev/null", "w", stderr) == nullptr))
    MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
  if (several && argc > 1 && std::strcmp(argv[1], "track") == 0)
    return fail("track writes to a folder as it proceeds, which only one process may do; run csrbf track");
  const auto is_resume = [](const char* argument) { return std::string_view(argument).starts_with("--resume"); };
  if (several && std::any_of(argv + 1, argv + argc, is_resume)) return fail("--resume is for one process; run csrbf");
  if (ranks.agreement().rank() > 0) discard_files();
  app::set_processes(&ranks);
  if (several) {
    set_work_sharing(&ranks);
    set_file_reader([&](const std::string& path) { return ranks.read(path); });
  }
  set_sparse_factor([&](const Eigen::SparseMatrix<double>& N) {
    return N.rows() >= fewest_shared_unknowns ? make_mumps_factor(MPI_COMM_WORLD, ranks.agreement()) : nullptr;
  });
  return app::run_program(argc, argv);
}

}  // namespace
}  // namespace csrbf::distributed

int main(int argc, char** argv) {
  using namespace csrbf::distributed;
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const bool pretends = argc > 1 && std::strcmp(argv[1], pretend_flag) == 0;
  const int code = pretends && ranks == 1 ? pretend(argc, argv) : run_on_ranks(argc, argv);
  MPI_Finalize();
  return code;
}
