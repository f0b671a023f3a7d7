#pragma once

#include <nlohmann/json.hpp>

#include <functional>

namespace csrbf::app {

/// The processes of a run, each of which runs the whole program with the same command line. Usually there is only one,
/// as in this class; several do the following in lockstep.
class Processes {
 public:
  Processes() = default;
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;
  virtual ~Processes() = default;

  /// Threads of each process unless the user sets them; 0 = all cores.
  [[nodiscard]] virtual int threads() const { return 0; }

  /// Whether any of them was asked to stop.
  virtual bool interrupted();

  /// Runs all of the work; an error in one process is an error in all.
  virtual void conclude(const std::function<void()>& work) { work(); }

  /// What the report says about them.
  virtual void describe(nlohmann::ordered_json& /*report*/) const {}
};

/// Those of this run.
Processes& processes();

/// Sets those of this run, which must outlive it; null: a single process.
void set_processes(Processes* processes);

}  // namespace csrbf::app
