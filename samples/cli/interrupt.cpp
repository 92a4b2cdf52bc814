#include "samples/cli/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace radivox::cli {

namespace {

volatile std::sig_atomic_t interrupted = 0;

void note(int) { interrupted = 1; }

}  // namespace

void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction before {};
    // nohup and background jobs ignore SIGINT on purpose.
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

void ignoreFileSizeSignal() { std::signal(SIGXFSZ, SIG_IGN); }

bool isInterrupted() { return interrupted != 0; }

void stopIfInterrupted() {
  if (isInterrupted()) throw Interrupted{};
}

}  // namespace radivox::cli
