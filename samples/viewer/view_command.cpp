#include "samples/viewer/view_command.h"

#include "engine/error.h"
#include "samples/viewer/headless.h"
#ifdef RADIVOX_WITH_WINDOW
#include "samples/viewer/window/run_window.h"
#else
#include "samples/cli/missing.h"
#endif

namespace radivox::viewer {

int runView(const ViewOptions& view, const cli::Options& options) {
#ifdef RADIVOX_WITH_WINDOW
  if (!view.headless) return runWindow(view, options);
  if (view.panels || view.truth) return runHeadlessPanels(view, options);
#else
  const std::string mend = std::string("; ") + cli::kGetWindow;
  if (!view.headless) throw Error(ErrorCode::Unsupported, "this build has no window" + mend + ", or use --headless --out FILE");
  if (view.panels || view.truth) throw Error(ErrorCode::Unsupported, "--panels and --truth: this build has no panels" + mend);
#endif
  return runHeadless(view, options);
}

}  // namespace radivox::viewer
