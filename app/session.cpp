#include "session.hpp"

#include "process/peak_memory.hpp"
#include "process/processes.hpp"

#include "csrbf/core/parallel.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/version.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cstdio>
#include <filesystem>
#include <system_error>

namespace csrbf::app {
namespace {

constexpr double bytes_per_mb = 1024 * 1024;

double peak_memory_mb() {
  return static_cast<double>(peak_memory_bytes()) / bytes_per_mb;
}

double in_mb(std::size_t bytes) {
  return std::round(static_cast<double>(bytes) / bytes_per_mb);
}

Json describe(const MemoryCap& cap) {
  return {
      {"cap_mb", in_mb(cap.bytes())}, {"scratch", cap.scratch()}, {"peak_scratch_mb", in_mb(cap.peak_scratch_bytes())}};
}

double round_to_ms(double seconds) {
  constexpr double per_second = 1000;
  return std::round(per_second * seconds) / per_second;
}

Json describe(const ResumeLog& log) {
  const ResumeLog::Use& use = log.use();
  return {{"taken_over_mb", in_mb(use.taken_bytes)},
          {"written_mb", in_mb(use.written_bytes)},
          {"seconds_saved", round_to_ms(use.seconds_saved)}};
}

// Everything that determines the results of a run, in lines.
std::string key_of(const std::string& subcommand, const CommonOptions& common, const std::string& input) {
  std::string key = std::string("csrbf ") + CSRBF_VERSION + "\n" + subcommand + "\n";
  for (const FlagUse& flag : common.flags)
    if (flag.given && !flag.common && flag.name != "output" && flag.name != "resume")
      key += "--" + flag.name + " " + flag.value + "\n";
  return key + "input of " + std::to_string(std::filesystem::file_size(input)) + " bytes with fingerprint " +
         std::to_string(fingerprint(input)) + "\n";
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
  set_thread_count(common.threads > 0 ? common.threads : processes().threads());
  if (!common.memory.empty()) memory_cap_.emplace(parse_bytes(common.memory, "--memory"), common.scratch);
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
    return !processes().interrupted();
  };
}

void Session::begin_stage(const std::string& stage) {
  if (processes().interrupted()) throw Cancelled();
  display_.update(stage, 0);
#ifdef __GLIBC__
  malloc_trim(0);  // returns the memory of earlier stages before this one allocates
#endif
}

void Session::end_stage(const std::string& stage, Clock::time_point start) {
  add_time(stage, std::chrono::duration<double>(Clock::now() - start).count());
  if (processes().interrupted()) throw Cancelled();
}

void Session::add_time(const std::string& stage, double seconds) {
  time_[stage] = round_to_ms(time_.value(stage, 0.0) + seconds);
}

void Session::expect_output(const std::string& path) {
  if (path == "-") {
    stdout_is_result_ = true;
    return;
  }
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && std::filesystem::is_other(status))
    return;  // opening a pipe twice would end it
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

void Session::resume(const std::string& file, const std::string& output) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw UsageError("--resume needs an input that can be read again; give a file instead of " + display_name(file));
  if (output == "-") throw UsageError("--resume keeps its log beside the output; give a file instead of -");
  const std::string path = output + ".resume";
  try {
    resume_log_.emplace(path, key_of(command_, common_, file));
  } catch (const IoError& failure) {
    throw WriteFailure(failure.what());
  }
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
  if (resume_log_) report["resume"] = describe(*resume_log_);
  if (memory_cap_) report["memory"] = describe(*memory_cap_);
  processes().describe(report);
  return report;
}

// The results are correct, but a flag about the way there was not met.
void Session::warn_of_unmet_flags() {
  if (memory_cap_ && peak_memory_mb() * bytes_per_mb > static_cast<double>(memory_cap_->bytes()))
    warn("--memory " + common_.memory + " was exceeded: the peak was " + rounded(peak_memory_mb()) + " MiB");
  if (resume_log_ && resume_log_->use().error != 0)
    warn("--resume: no more steps could be saved: " + std::generic_category().message(resume_log_->use().error));
}

void Session::finish() {
  warn_of_unmet_flags();
  const Json report = this->report();
  for (const std::string& path : common_.reports) {
    const std::string text = report_form(path) == ReportForm::html
                                 ? html_page(report, common_, summary_, page_)
                                 : report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    write([&] { write_file(path, text); });
  }
  if (!common_.job.empty()) write_file(common_.job, report.dump(-1, ' ', false, Json::error_handler_t::replace));
  if (resume_log_) {
    resume_log_->remove();
    const double seconds = resume_log_->use().seconds_saved;
    if (seconds > 0) say("resumed: " + rounded(seconds, 2) + " s of work reused from the earlier run");
  }
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
