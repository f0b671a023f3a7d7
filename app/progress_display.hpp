#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace csrbf::app {

/// Shows on standard error how far the work is: a bar on a terminal, plain lines elsewhere when asked for.
class ProgressDisplay {
 public:
  /// `mode` is auto (a bar, on a terminal only), always or never.
  explicit ProgressDisplay(const std::string& mode);
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;
  ~ProgressDisplay() { clear(); }

  /// The stage at hand and the fraction of it that is done.
  void update(std::string_view stage, double fraction);

  /// Removes the bar, so that other text can be written.
  void clear();

 private:
  enum class Style { none, bar, lines };
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::string remaining(double fraction) const;

  Style style_ = Style::none;
  std::string stage_;
  Clock::time_point stage_start_, last_shown_;
  double last_fraction_ = 0;
  bool visible_ = false;
};

}  // namespace csrbf::app
