#pragma once

#include <nlohmann/json.hpp>

#include <functional>

namespace csrbf::app {

/// The processes that run the program together, every one of them the whole of it on the same command line. Usually
/// there is one, as in this class; for several all do the following in step.
class Processes {
 public:
  Processes() = default;
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;
  virtual ~Processes() = default;

  /// Threads of each process unless the user says; 0 = all cores.
  [[nodiscard]] virtual int threads() const { return 0; }

  /// Whether any of them was asked to stop.
  virtual bool interrupted();

  /// All of the work: an error of one of them is the error of all.
  virtual void conclude(const std::function<void()>& work) { work(); }

  /// What the report says about them.
  virtual void describe(nlohmann::ordered_json& /*report*/) const {}
};

/// Those of this run.
Processes& processes();

/// Sets those of this run, which must outlive it; null: one process by itself.
void set_processes(Processes* processes);

}  // namespace csrbf::app
