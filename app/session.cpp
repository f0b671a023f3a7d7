#include "session.hpp"

#include "process/interrupt.hpp"
#include "process/peak_memory.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/open_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/version.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace csrbf::app {
namespace {

constexpr double bytes_per_mb = 1024 * 1024;

double peak_memory_mb() {
  return static_cast<double>(peak_memory_bytes()) / bytes_per_mb;
}

double round_to_ms(double seconds) {
  constexpr double per_second = 1000;
  return std::round(per_second * seconds) / per_second;
}

enum class ReportForm { json, html, unknown };

// Devices and pipes have no extension and get JSON.
ReportForm report_form(const std::string& path) {
  const std::string extension = file_extension(path);
  if (extension == ".html" || extension == ".htm") return ReportForm::html;
  return extension.empty() || extension == ".json" ? ReportForm::json : ReportForm::unknown;
}

}  // namespace

Session::Session(std::string subcommand, const CommonOptions& common)
    : command_(std::move(subcommand)),
      common_(common),
      display_(!common.job.empty() ? "slicer"
               : common.quiet      ? "never"
                                   : common.progress) {
  set_thread_count(common.threads);
  for (const std::string& path : common.reports) {
    if (report_form(path) == ReportForm::unknown)
      throw UsageError("--report " + path + ": unknown extension \"" + file_extension(path) +
                       "\"; reports are .json or .html");
    expect_output(path);
  }
}

Progress Session::progress() {
  return [this](std::string_view stage, double fraction) {
    display_.update(stage, fraction);
    return !interrupted();
  };
}

void Session::begin_stage(const std::string& stage) {
  if (interrupted()) throw Cancelled();
  display_.update(stage, 0);
#ifdef __GLIBC__
  malloc_trim(0);  // returns the memory of earlier stages before this one allocates
#endif
}

void Session::end_stage(const std::string& stage, Clock::time_point start) {
  add_time(stage, std::chrono::duration<double>(Clock::now() - start).count());
  if (interrupted()) throw Cancelled();
}

void Session::add_time(const std::string& stage, double seconds) {
  time_[stage] = round_to_ms(time_.value(stage, 0.0) + seconds);
}

void Session::expect_output(const std::string& path) {
  if (path == "-") {
    if (stdout_is_result_) throw UsageError("-: standard output takes one result; write the others to files");
    stdout_is_result_ = true;
    return;
  }
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && std::filesystem::is_other(status))
    return;  // opening a pipe twice would end it
  if (!may_replace_input) expect_no_other(path);
  try {
    const AtomicFile probe(path);
  } catch (const IoError& failure) {
    throw WriteFailure(failure.what());
  }
}

void Session::expect_output(const std::string& flag, const std::string& path, const char* extension,
                            const char* files) {
  if (file_extension(path) != extension) throw UsageError(flag + " " + path + ": " + files + " are " + extension);
  expect_output(path);
}

void Session::expect_output(const std::string& flag, const std::string& path, bool known, const std::string& formats) {
  if (!known) throw UsageError(flag + " " + path + ": unknown extension \"" + file_extension(path) + "\"; " + formats);
  expect_output(path);
}

// What is read would be lost, and of two results one.
void Session::expect_no_other(const std::string& path) const {
  const auto is_same = [&](const std::string& value) {
    std::error_code none_there;
    return value == path || std::filesystem::equivalent(utf8_path(value), utf8_path(path), none_there);
  };
  if (std::count_if(common_.values.begin(), common_.values.end(), is_same) > 1)
    throw UsageError(path + ": is the input, or another output, which would be lost; give another name");
}

void Session::warn(const std::string& message) {
  warnings_.push_back(message);
  if (common_.quiet) return;
  display_.clear();
  std::fprintf(stderr, "csrbf %s: warning: %s\n", command_.c_str(), message.c_str());
}

void Session::warn(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) warn(message);
}

bool Session::has_flag(const std::string& name) const {
  return std::any_of(common_.flags.begin(), common_.flags.end(),
                     [&](const FlagUse& flag) { return flag.name == name; });
}

bool Session::is_given(const std::string& name) const {
  return std::any_of(common_.flags.begin(), common_.flags.end(),
                     [&](const FlagUse& flag) { return flag.name == name && flag.given; });
}

bool Session::wants_page() const {
  return std::any_of(common_.reports.begin(), common_.reports.end(),
                     [](const std::string& path) { return report_form(path) == ReportForm::html; });
}

// The report states the peak of the work, not of its pictures.
void Session::note_memory() {
  if (memory_mb_ == 0) memory_mb_ = peak_memory_mb();
}

Json Session::report() const {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count() - page_seconds_;
  Json time = {{"total", round_to_ms(seconds)}};
  time.update(time_);
  Json report = {{"csrbf", CSRBF_VERSION},
                 {"command", command_},
                 {"input", input},
                 {"options", options},
                 {"result", result},
                 {"time", time},
                 {"peak_memory_mb", std::round(memory_mb_ > 0 ? memory_mb_ : peak_memory_mb())},
                 {"threads", thread_count()},
                 {"warnings", warnings_}};
  return report;
}

void Session::finish() {
  const Json report = this->report();
  for (const std::string& path : common_.reports) {
    const std::string text = report_form(path) == ReportForm::html
                                 ? html_page(report, common_, summary_, page_)
                                 : report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    write([&] { write_file(path, text); });
  }
  if (!common_.job.empty()) write_file(common_.job, report.dump(-1, ' ', false, Json::error_handler_t::replace));
  display_.clear();
  if (common_.quiet) return;
  std::FILE* out = stdout_is_result_ ? stderr : stdout;
  for (const std::string& line : summary_) std::fprintf(out, "%s\n", line.c_str());
  if (common_.verbose) {
    std::fprintf(stderr, "options: %s\n", options.dump().c_str());
    std::fprintf(stderr, "time: %s\n", report["time"].dump().c_str());
  }
}

}  // namespace csrbf::app
