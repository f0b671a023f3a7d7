#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace csrbf::app {

/// Shows progress on standard error: a bar on a terminal, plain lines elsewhere when asked for. For 3D Slicer it
/// reports the same on standard output, as XML elements.
class ProgressDisplay {
 public:
  /// `mode` is auto (a bar, on a terminal only), always, never or slicer.
  explicit ProgressDisplay(const std::string& mode);
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;
  ~ProgressDisplay();

  /// The current stage and the fraction of it that is done.
  void update(std::string_view stage, double fraction);

  /// Removes the bar, so that other text can be written.
  void clear();

 private:
  enum class Style { none, bar, lines, slicer };
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] std::string remaining(double fraction) const;
  void begin_filter() const;
  void end_filter() const;

  Style style_ = Style::none;
  std::string stage_;
  Clock::time_point stage_start_, last_shown_;
  double last_fraction_ = 0;
  bool visible_ = false;
};

}  // namespace csrbf::app
