#include "progress_display.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace csrbf::app {
namespace {

using namespace std::chrono_literals;

constexpr auto bar_interval = 100ms;  // as fast as the eye can follow
constexpr auto line_interval = 2s;    // keeps logs short
constexpr int bar_width = 30;         // columns: the line fits a terminal of 80

bool is_terminal() {
  const char* term = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && term != nullptr && std::string_view(term) != "dumb";
}

std::string duration(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return std::to_string(whole) + " s";
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole / 60 % 60) + " min";
}

}  // namespace

ProgressDisplay::ProgressDisplay(const std::string& mode) {
  if (mode == "slicer")
    style_ = Style::slicer;
  else if (mode != "never" && is_terminal())
    style_ = Style::bar;
  else if (mode == "always")
    style_ = Style::lines;
}

ProgressDisplay::~ProgressDisplay() {
  clear();
  if (style_ == Style::slicer) end_filter();
}

void ProgressDisplay::update(std::string_view stage, double fraction) {
  if (style_ == Style::none) return;
  const auto now = Clock::now();
  fraction = std::clamp(fraction, 0.0, 1.0);
  const bool new_stage = stage != stage_;
  if (new_stage) {
    if (style_ == Style::slicer) end_filter();
    stage_ = stage;
    stage_start_ = now;
    if (style_ == Style::slicer) begin_filter();
  }
  const bool ended = fraction >= 1 && last_fraction_ < 1;
  const auto interval = style_ == Style::lines ? Clock::duration(line_interval) : Clock::duration(bar_interval);
  if (!new_stage && !ended && now - last_shown_ < interval) return;
  last_shown_ = now;
  last_fraction_ = fraction;

  const int percent = static_cast<int>(100 * fraction);
  const std::string left = remaining(fraction);
  if (style_ == Style::slicer) {
    std::printf("<filter-progress>%.3f</filter-progress>\n", fraction);
    std::fflush(stdout);
  } else if (style_ == Style::lines) {
    std::fprintf(stderr, "%s %d %%%s\n", stage_.c_str(), percent, left.c_str());
  } else {
    const std::string done(static_cast<std::size_t>(bar_width * fraction), '#');
    std::fprintf(stderr, "\r\033[K%-11s [%-*s] %3d %%%s", stage_.c_str(), bar_width, done.c_str(), percent,
                 left.c_str());
    visible_ = true;
  }
  std::fflush(stderr);
}

// Known once a part is done; early estimates are unreliable.
std::string ProgressDisplay::remaining(double fraction) const {
  const double elapsed = std::chrono::duration<double>(Clock::now() - stage_start_).count();
  // The part done and the seconds passed before the rest is estimated; chosen by hand.
  constexpr double smallest_fraction = 0.02, shortest = 0.5;
  if (fraction < smallest_fraction || fraction >= 1 || elapsed < shortest) return "";
  return ", " + duration(elapsed * (1 - fraction) / fraction) + " left";
}

// A stage is a filter to Slicer.
void ProgressDisplay::begin_filter() const {
  std::printf("<filter-start>\n<filter-name>%s</filter-name>\n<filter-comment>%s</filter-comment>\n</filter-start>\n",
              stage_.c_str(), stage_.c_str());
}

void ProgressDisplay::end_filter() const {
  if (stage_.empty()) return;
  const double seconds = std::chrono::duration<double>(Clock::now() - stage_start_).count();
  std::printf("<filter-end>\n<filter-name>%s</filter-name>\n<filter-time>%.3f</filter-time>\n</filter-end>\n",
              stage_.c_str(), seconds);
  std::fflush(stdout);
}

void ProgressDisplay::clear() {
  if (!visible_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  visible_ = false;
}

}  // namespace csrbf::app
