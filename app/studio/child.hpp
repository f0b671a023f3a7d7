#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace csrbf::app {

/// This program, running a command in a process of its own: it can be stopped, and its memory is returned in the end.
class Child {
 public:
  /// Starts it with these arguments in `folder`.
  Child(const std::vector<std::string>& arguments, const std::filesystem::path& folder);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child();  ///< ends it, when it is still running

  using OnProgress = std::function<void(const std::string& stage, double fraction)>;

  /// Waits for something to happen, at most for `longest`; true once it has ended.
  bool wait(std::chrono::milliseconds longest, const OnProgress& progress);

  /// Asks it to stop, as Ctrl-C does; kills it when it does not within some seconds.
  void stop();

  [[nodiscard]] int status() const { return status_; }                 ///< exit status; 128 + signal
  [[nodiscard]] const std::string& output() const { return output_; }  ///< without the progress
  [[nodiscard]] const std::string& errors() const { return errors_; }

 private:
  using Clock = std::chrono::steady_clock;

  bool read_from(int& pipe, std::string& text);
  void take_progress(const OnProgress& progress);
  void kill_when_late();
  void reap();

  pid_t pid_ = -1;
  int out_ = -1, err_ = -1;
  std::string unread_, stage_;  // of standard output
  std::string output_, errors_;
  Clock::time_point stopped_{};
  int status_ = 0;
};

}  // namespace csrbf::app
