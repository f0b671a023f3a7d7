#include "studio/job.hpp"

#include "csrbf/io/files/read_file.hpp"

#include <sstream>

namespace csrbf::app {
namespace {

// What the program says in the end, without its warnings, which the report has as well.
std::string failure_of(const Child& child) {
  std::string message;
  std::istringstream lines(child.errors());
  for (std::string line; std::getline(lines, line);)
    if (line.find(": warning: ") == std::string::npos) message += (message.empty() ? "" : "\n") + line;
  if (message.starts_with("csrbf")) message.erase(0, message.find(": ") + 2);
  if (!message.empty()) return message;
  return "the command ended without a message (status " + std::to_string(child.status()) + ")";
}

}  // namespace

JobRequest parse_job(const std::string& body) {
  constexpr int bad = 400, too_large = 413;
  constexpr std::size_t most_request = 1U << 20U;  // bytes
  if (body.size() > most_request) throw Refused(too_large, "the request is too large");
  const Json asked = Json::parse(body, nullptr, false);
  if (!asked.is_object() || !asked.contains("command") || !asked["command"].is_string() || !asked.contains("args") ||
      !asked["args"].is_array())
    throw Refused(bad, "a request has a command and a list of args");
  const std::string command = asked["command"];
  if (command.starts_with("-") || command == "studio") throw Refused(bad, "\"" + command + "\" is no command for this");
  std::vector<std::string> arguments{command};
  for (const Json& argument : asked["args"]) {
    if (!argument.is_string()) throw Refused(bad, "args are texts");
    if (argument.get<std::string>().starts_with(job_flag))
      throw Refused(bad, argument.get<std::string>() + " is for the studio itself");
    arguments.push_back(argument);
  }
  return {std::move(arguments), asked.value("preview", false)};
}

Job::~Job() {
  child_.reset();
  if (has_slot_) slots_.release(preview_);
  std::error_code error;
  if (!report_.empty()) std::filesystem::remove(report_, error);
}

void Job::start(const WorkFolder& folder) {
  static std::atomic<int> count = 0;
  report_ = folder.preview_path().parent_path() / ("report-" + std::to_string(++count) + ".json");
  before_ = folder.snapshot(preview_);
  std::vector<std::string> arguments = arguments_;
  arguments.insert(arguments.end(), {job_flag, report_.string()});
  child_ = std::make_unique<Child>(arguments, preview_ ? folder.preview_path() : folder.path());
}

Json Job::outcome() const {
  Json outcome = {{"status", child_->status()},
                  {"seconds", std::chrono::duration<double>(Clock::now() - start_).count()}};
  if (child_->status() != 0) {
    outcome["error"] = failure_of(*child_);
    return outcome;
  }
  outcome["summary"] = child_->output();
  outcome["report"] = Json::parse(read_file(report_.string()));
  return outcome;
}

}  // namespace csrbf::app
