#include "process/interrupt.hpp"

#include <csignal>
#include <cstdlib>
#include <initializer_list>

namespace csrbf::app {
namespace {

volatile std::sig_atomic_t received = 0;

constexpr int signal_base = 128;  // exit codes of shells: this + the number of the signal

void handle(int signal) {
  if (received != 0) std::_Exit(signal_base + signal);
  received = signal;
#ifdef _WIN32
  std::signal(signal, handle);  // Windows forgets the handler when it calls it
#endif
}

}  // namespace

#ifdef _WIN32

void catch_interrupts() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, handle);
}

#else

void catch_interrupts() {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is a write error
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // nohup and shell background jobs
    action.sa_handler = handle;
    action.sa_flags = 0;
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
  }
}

#endif

bool interrupted() {
  return received != 0;
}

int interrupt_exit_code() {
  return signal_base + (received != 0 ? received : SIGINT);
}

}  // namespace csrbf::app
