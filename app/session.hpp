#pragma once

#include "common.hpp"
#include "progress_display.hpp"
#include "report/page.hpp"

#include "csrbf/core/progress.hpp"

#include <chrono>
#include <type_traits>

namespace csrbf::app {

/// A result cannot be written.
class WriteFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One run of a command: its report, summary, times, progress and interruption.
class Session {
 public:
  Session(std::string subcommand, const CommonOptions& common);

  Json input = Json::object();    ///< parts of the report
  Json options = Json::object();  ///< every option with the value used
  Json result = Json::object();

  /// Stage "report": lets `action(page)` add the part of the command to the HTML report; does nothing when none was
  /// asked for. Its time is not part of the total.
  template <class Action>
  void add_to_page(Action&& action);

  /// Was an HTML report asked for?
  [[nodiscard]] bool wants_page() const;

  /// For the options of long computations: shows their progress, and stops them after Ctrl-C.
  [[nodiscard]] Progress progress();

  /// Runs `action`, adds its time to the stage and returns its result. Throws Cancelled after Ctrl-C.
  template <class Action>
  std::invoke_result_t<Action> timed(const std::string& stage, Action&& action);

  /// Adds seconds to a stage.
  void add_time(const std::string& stage, double seconds);

  /// Throws WriteFailure when a result could not be written later, and UsageError when another argument or flag of the
  /// command names the same file. Results in "-" keep the summary off standard output.
  void expect_output(const std::string& path);
  /// The same. Throws UsageError first unless the extension is `extension`, that of all `files`.
  void expect_output(const std::string& flag, const std::string& path, const char* extension, const char* files);
  /// The same. Throws UsageError first unless the extension is `known`; `formats`: "meshes are .ply .obj".
  void expect_output(const std::string& flag, const std::string& path, bool known, const std::string& formats);

  /// Stage "write": turns IoError into WriteFailure.
  template <class Action>
  void write(Action&& action);

  /// A warning, on standard error and in the report.
  void warn(const std::string& message);
  void warn(const std::vector<std::string>& messages);

  /// Does the command have this flag (without its dashes), and was it given?
  [[nodiscard]] bool has_flag(const std::string& name) const;
  [[nodiscard]] bool is_given(const std::string& name) const;

  /// A line of the summary.
  void say(const std::string& line) { summary_.push_back(line); }

  /// Writes the reports and the summary.
  void finish();

  bool may_replace_input = false;  ///< the output has all that the input has

 private:
  using Clock = std::chrono::steady_clock;

  void begin_stage(const std::string& stage);
  void end_stage(const std::string& stage, Clock::time_point start);
  [[nodiscard]] Json report() const;
  void note_memory();
  void expect_no_other(const std::string& path) const;

  std::string command_;
  CommonOptions common_;
  ProgressDisplay display_;
  Clock::time_point start_ = Clock::now();
  Json time_ = Json::object();
  std::vector<std::string> warnings_;
  std::vector<std::string> summary_;
  bool stdout_is_result_ = false;
  Page page_;
  double memory_mb_ = 0;     // before work on a page began; 0: it did not
  double page_seconds_ = 0;  // not counted in the total
};

template <class Action>
std::invoke_result_t<Action> Session::timed(const std::string& stage, Action&& action) {
  begin_stage(stage);
  const auto start = Clock::now();
  if constexpr (std::is_void_v<std::invoke_result_t<Action>>) {
    action();
    end_stage(stage, start);
  } else {
    auto value = action();
    end_stage(stage, start);
    return value;
  }
}

template <class Action>
void Session::add_to_page(Action&& action) {
  if (!wants_page()) return;
  note_memory();
  const auto start = Clock::now();
  timed("report", [&] { action(page_); });
  page_seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
}

template <class Action>
void Session::write(Action&& action) {
  timed("write", [&] {
    try {
      action();
    } catch (const IoError& error) {
      throw WriteFailure(error.what());
    }
  });
}

}  // namespace csrbf::app
