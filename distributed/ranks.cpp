#include "ranks.hpp"

#include "traffic_report.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/process_files.hpp"

#ifdef __linux__
#include <sched.h>
#endif

#include <algorithm>
#include <array>
#include <climits>
#include <ctime>
#include <thread>

namespace csrbf::distributed {
namespace {

constexpr std::size_t broadcast_at_once = std::size_t{1} << 30;  // bytes: MPI counts them in an int

int cores_of_this_process() {
#ifdef __linux__
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof(set), &set) == 0) return CPU_COUNT(&set);
#endif
  return static_cast<int>(std::thread::hardware_concurrency());
}

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Adds the CPU time of its lifetime.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum), start_(cpu_seconds()) {}
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() { sum_ += cpu_seconds() - start_; }

 private:
  double& sum_;
  double start_;
};

}  // namespace

Ranks::Ranks(MPI_Comm comm) : comm_(comm), agreement_(comm) {}

int Ranks::threads() const {
  MPI_Comm node{};
  MPI_Comm_split_type(comm_, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  int ranks = 1;
  MPI_Comm_size(node, &ranks);
  MPI_Comm_free(&node);
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  return std::max(1, std::min(cores_of_this_process(), cores / ranks));
}

bool Ranks::interrupted() {
  const Stopwatch stopwatch(waiting_);
  return agreement_.agree();
}

void Ranks::conclude(const std::function<void()>& work) {
  try {
    work();
  } catch (...) {
    const std::exception_ptr error = std::current_exception();
    if (!agreement_.is_agreed(error)) agreement_.agree(error);
    throw;
  }
  agreement_.agree();
}

void Ranks::describe(nlohmann::ordered_json& report) const {
  const auto largest = [this](double value) {
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, comm_);
    return value;
  };
  report["peak_memory_mb"] = largest(report["peak_memory_mb"]);
  if (report.contains("memory")) report["memory"]["peak_scratch_mb"] = largest(report["memory"]["peak_scratch_mb"]);
  report["ranks"] = agreement_.size();
  report["busy_seconds"] = largest(cpu_seconds() - waiting_);
  report["shared_work"] = to_json(traffic_);
}

void Ranks::share(const SharedWork& work) {
  const int rank = agreement_.rank(), ranks = agreement_.size();
  const auto first = [&](int r) { return first_block(work.blocks(), r, ranks); };
  Traffic& traffic = traffic_.try_emplace(std::string(work.name)).first->second;
  std::exception_ptr failure;
  try {
    const Stopwatch stopwatch(traffic.seconds);
    work.compute_blocks(first(rank), first(rank + 1));
  } catch (...) {
    failure = std::current_exception();
  }
  {
    const Stopwatch stopwatch(waiting_);
    agreement_.go_on(failure);
  }
  ++traffic.works;
  traffic.items += work.items;
  if (first(rank) < first(rank + 1)) traffic.computed += work.end(first(rank + 1) - 1) - work.begin(first(rank));
  std::vector<Index> next(ranks);  // block of each rank that comes next
  for (int r = 0; r < ranks; ++r) next[r] = first(r);
  Index mine = first(rank), done = 0;
  ByteWriter out;
  Round round;
  while (done < work.blocks()) {
    const Index before = mine;
    pack_some(work, mine, first(rank + 1), most_at_once(ranks), out);
    exchange(out.bytes(), mine - before, round);
    unpack(work, round, next);
    for (const std::int64_t blocks : round.blocks) done += blocks;
    ++traffic.rounds;
    traffic.sent += static_cast<std::int64_t>(out.bytes().size());
    traffic.received += static_cast<std::int64_t>(round.received.size() - out.bytes().size());
  }
}

void Ranks::exchange(std::span<const std::byte> mine, std::int64_t blocks, Round& round) {
  const Stopwatch stopwatch(waiting_);
  const auto ranks = static_cast<std::size_t>(agreement_.size());
  const std::array<std::int64_t, 2> own{static_cast<std::int64_t>(mine.size()), blocks};
  std::vector<std::int64_t> all(2 * ranks);
  MPI_Allgather(own.data(), 2, MPI_INT64_T, all.data(), 2, MPI_INT64_T, comm_);
  round.blocks.resize(ranks);
  round.bytes.resize(ranks);
  round.begin.resize(ranks);
  std::int64_t total = 0;
  for (std::size_t r = 0; r < ranks; ++r) {
    round.begin[r] = static_cast<int>(total);
    round.bytes[r] = static_cast<int>(all[2 * r]);
    round.blocks[r] = all[2 * r + 1];
    total += all[2 * r];
    if (total > INT_MAX) throw SolverFailure("shared work: a block of results is too large to be sent");
  }
  round.received.resize(total);
  MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), MPI_BYTE, round.received.data(), round.bytes.data(),
                 round.begin.data(), MPI_BYTE, comm_);
}

void Ranks::unpack(const SharedWork& work, const Round& round, std::vector<Index>& next) const {
  for (std::size_t r = 0; r < next.size(); ++r) {
    const Index last = next[r] + round.blocks[r];
    if (static_cast<int>(r) == agreement_.rank()) {
      next[r] = last;
      continue;
    }
    ByteReader in(std::span(round.received)
                      .subspan(static_cast<std::size_t>(round.begin[r]), static_cast<std::size_t>(round.bytes[r])));
    for (; next[r] < last; ++next[r]) work.unpack(work.begin(next[r]), work.end(next[r]), in);
  }
}

std::string Ranks::read(const std::string& path) {
  std::string content;
  std::exception_ptr failure;
  try {
    if (agreement_.rank() == 0) content = read_file_here(path);
  } catch (...) {
    failure = std::current_exception();
  }
  const Stopwatch stopwatch(waiting_);
  agreement_.go_on(failure);
  std::uint64_t size = content.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, 0, comm_);
  try {
    content.resize(size);
  } catch (...) {
    failure = std::current_exception();
  }
  agreement_.go_on(failure);
  for (std::size_t begin = 0; begin < size; begin += broadcast_at_once)
    MPI_Bcast(content.data() + begin, static_cast<int>(std::min(broadcast_at_once, size - begin)), MPI_BYTE, 0, comm_);
  return content;
}

}  // namespace csrbf::distributed
