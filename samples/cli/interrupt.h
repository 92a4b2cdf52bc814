// Ctrl-C and SIGTERM: noted, asked for between steps, answered with exit code 130.
#pragma once

namespace radivox::cli {

constexpr int kInterruptedExitCode = 130;

/// Thrown where the work ends early; main turns it into the exit code.
struct Interrupted {};

/// The first signal is noted; a second one ends the process at once.
void catchInterrupts();
/// A file that grows past the limit is an error with a name (EFBIG), not the end of the process.
void ignoreFileSizeSignal();
bool isInterrupted();
/// Throws Interrupted if a signal came.
void stopIfInterrupted();

}  // namespace radivox::cli
