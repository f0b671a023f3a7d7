#pragma once

#include "common.hpp"
#include "studio/child.hpp"
#include "studio/work_folder.hpp"

#include <array>
#include <atomic>
#include <memory>

namespace csrbf::app {

/// How often the page hears of a command: a closed page is noticed after twice that.
inline constexpr std::chrono::milliseconds heartbeat{250};

/// What the page asks for.
struct JobRequest {
  std::vector<std::string> arguments;  ///< the command first
  bool preview = false;
};

/// From {"command": ..., "args": [...], "preview": ...}. Throws Refused 400, 413.
JobRequest parse_job(const std::string& body);

/// Places for commands that run: one for previews and one for all others.
class Slots {
 public:
  bool take(bool preview) { return !taken_[preview ? 1 : 0].exchange(true); }
  void release(bool preview) { taken_[preview ? 1 : 0] = false; }

 private:
  std::array<std::atomic<bool>, 2> taken_{};
};

/// A command that the page asked for. Destroying it ends the command.
class Job {
 public:
  Job(std::vector<std::string> arguments, bool preview, Slots& slots)
      : arguments_(std::move(arguments)), preview_(preview), slots_(slots) {}
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;
  ~Job();

  [[nodiscard]] bool preview() const { return preview_; }
  [[nodiscard]] bool is_running() const { return child_ != nullptr; }
  bool take_slot() { return has_slot_ = has_slot_ || slots_.take(preview_); }
  void start(const WorkFolder& folder);
  /// Waits a moment for something to happen; true once it has ended.
  bool wait(const Child::OnProgress& progress) { return child_->wait(heartbeat, progress); }
  /// Status, seconds, and the summary and report or the error.
  [[nodiscard]] Json outcome() const;
  [[nodiscard]] const WorkFolder::Snapshot& before() const { return before_; }

 private:
  using Clock = std::chrono::steady_clock;

  std::vector<std::string> arguments_;
  bool preview_;
  Slots& slots_;
  bool has_slot_ = false;
  std::unique_ptr<Child> child_;
  std::filesystem::path report_;
  WorkFolder::Snapshot before_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace csrbf::app
