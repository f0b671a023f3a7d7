#include "studio/child.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/text.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#ifdef __APPLE__
#include <mach-o/dyld.h>
#elif defined(__linux__)
#include <sys/prctl.h>
#endif

namespace csrbf::app {
namespace {

using namespace std::chrono_literals;

constexpr auto patience = 3s;                 // after Ctrl-C, before the process is killed
constexpr std::size_t most_text = 1U << 20U;  // of messages: more is of no use

std::string own_program() {
#ifdef __APPLE__
  std::array<char, 4096> path{};
  std::uint32_t size = path.size();
  return _NSGetExecutablePath(path.data(), &size) == 0 ? path.data() : "csrbf";
#else
  return "/proc/self/exe";
#endif
}

// What was started in a terminal would get its Ctrl-C as well, but shall stop when the studio says so.
[[noreturn]] void become(const std::string& program, std::vector<char*>& arguments, const char* folder, int out,
                         int err) {
  setpgid(0, 0);
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGINT);  // nothing goes on when the studio is killed
#endif
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_DFL);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0 ||
      chdir(folder) != 0)
    _exit(127);
  const long most = sysconf(_SC_OPEN_MAX);
  constexpr long usual = 4096;  // descriptors that are open here
  for (int file = STDERR_FILENO + 1; file < std::min(most, usual); ++file) close(file);
  execv(program.c_str(), arguments.data());
  _exit(127);
}

// The text between <tag> and </tag>; null when the line is something else.
bool take_element(std::string_view line, std::string_view tag, std::string& text) {
  const std::string begin = "<" + std::string(tag) + ">", end = "</" + std::string(tag) + ">";
  if (!line.starts_with(begin) || !line.ends_with(end)) return false;
  text = line.substr(begin.size(), line.size() - begin.size() - end.size());
  return true;
}

}  // namespace

Child::Child(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  std::array<int, 2> out{}, err{};
  if (pipe(out.data()) != 0) throw IoError("studio: no pipe: " + std::string(std::strerror(errno)));
  if (pipe(err.data()) != 0) {
    close(out[0]);
    close(out[1]);
    throw IoError("studio: no pipe: " + std::string(std::strerror(errno)));
  }
  const std::string program = own_program(), place = folder.string();
  std::vector<std::string> words{"csrbf"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) become(program, pointers, place.c_str(), out[1], err[1]);
  close(out[1]);
  close(err[1]);
  out_ = out[0];
  err_ = err[0];
  if (pid_ < 0) throw IoError("studio: no process: " + std::string(std::strerror(errno)));
  for (const int file : {out_, err_}) {
    fcntl(file, F_SETFL, O_NONBLOCK);
    fcntl(file, F_SETFD, FD_CLOEXEC);
  }
}

Child::~Child() {
  if (pid_ > 0) {
    ::kill(pid_, SIGINT);
    for (int i = 0; i < 40 && pid_ > 0; ++i) wait(50ms, nullptr);
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
  }
  for (const int file : {out_, err_})
    if (file >= 0) close(file);
}

void Child::stop() {
  if (pid_ <= 0 || stopped_ != Clock::time_point{}) return;
  stopped_ = Clock::now();
  ::kill(pid_, SIGINT);
}

void Child::kill_when_late() {
  if (stopped_ != Clock::time_point{} && Clock::now() - stopped_ > patience) ::kill(pid_, SIGKILL);
}

// False at its end.
bool Child::read_from(int& pipe, std::string& text) {
  std::array<char, 1U << 14U> buffer{};
  for (;;) {
    const ssize_t count = read(pipe, buffer.data(), buffer.size());
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    if (count == 0) {
      close(pipe);
      pipe = -1;
      return false;
    }
    if (text.size() < most_text) text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

void Child::take_progress(const OnProgress& progress) {
  for (std::size_t end = unread_.find('\n'); end != std::string::npos; end = unread_.find('\n')) {
    const std::string line = unread_.substr(0, end);
    unread_.erase(0, end + 1);
    std::string text;
    if (take_element(line, "filter-name", stage_)) {
      if (progress) progress(stage_, 0);
    } else if (take_element(line, "filter-progress", text)) {
      if (progress) progress(stage_, parse_number(text).value_or(0));
    } else if (!line.starts_with("<filter-") && !line.starts_with("</filter-")) {
      output_ += line + "\n";
    }
  }
}

void Child::reap() {
  int state = 0;
  if (waitpid(pid_, &state, WNOHANG) != pid_) return;
  constexpr int signal_base = 128;
  status_ = WIFEXITED(state) ? WEXITSTATUS(state) : signal_base + WTERMSIG(state);
  pid_ = -1;
}

bool Child::wait(std::chrono::milliseconds longest, const OnProgress& progress) {
  if (pid_ <= 0) return true;
  kill_when_late();
  std::vector<pollfd> pipes;
  for (const int file : {out_, err_})
    if (file >= 0) pipes.push_back({file, POLLIN, 0});
  if (pipes.empty())
    usleep(1000);
  else
    poll(pipes.data(), pipes.size(), static_cast<int>(longest.count()));
  if (out_ >= 0) read_from(out_, unread_);
  if (err_ >= 0) read_from(err_, errors_);
  take_progress(progress);
  if (out_ < 0 && err_ < 0) reap();
  if (pid_ > 0) return false;
  output_ += unread_;
  unread_.clear();
  return true;
}

}  // namespace csrbf::app
