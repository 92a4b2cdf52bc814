#include "samples/report/budget.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/error.h"
#include "engine/text.h"
#include "samples/cli/cache.h"
#include "samples/cli/progress.h"
#include "samples/report/content_key.h"
#include "samples/report/measure.h"
#include "samples/report/row_cache.h"

namespace radivox::report {

namespace {

namespace fs = std::filesystem;

constexpr double kReferenceShare = 0.4;  ///< of the time for calibration
constexpr double kReferenceError = 0.02;
constexpr const char* kResolution = "voxelize.resolution";
/// A setting takes about this much longer to measure than its picture takes to make.
constexpr double kMeasureFactor = 3;

std::string describe(const Row& row) {
  return row.setting.print() + ": error " + printNumber(row.full.relRmse, 3) + ", " + printNumber(row.cost.totalMs(), 3) + " ms";
}

class Calibration {
 public:
  Calibration(const cli::Options& options, const Budget& budget)
      : options_(options),
        budget_(budget),
        size_(cli::parseSize(options.size)),
        scene_(scene::loadScene(options.scene, options.sky)),
        folder_(openFolder()),
        cache_(folder_) {
    gpu::DeviceOptions deviceOptions;
    deviceOptions.index = cli::parseDevice(options.device);
    deviceOptions.pipelineCacheFile = cli::pipelineCacheFile();
    device_ = gpu::Device::create(deviceOptions);
  }

  Choice run() {
    const scene::CameraDescription& camera = scene::findCamera(scene_, options_.camera.empty() ? "0" : options_.camera);
    const SceneTruth truth = trace(camera);
    const Bench bench{*device_, scene_, camera, truth, folder_, cli::isInterrupted, [this](std::string_view node, double fraction) {
                        bar_.show("calibration: " + std::string(node), fraction);
                      }};
    sceneKey_ = ContentKey()
                    .add(programKey())
                    .add(device_->capabilities().deviceName)
                    .add(device_->capabilities().driverInfo)
                    .add(scene_)
                    .add(camera)
                    .add(size_.width)
                    .add(size_.height)
                    .add(truth.key)
                    .print();
    std::vector<std::string> notes;
    methods_ = findMethods(options_, methodNames(), scene_, device_->capabilities(), notes);
    const std::string path = choicePath();
    if (auto known = readChoice(path)) return *known;
    for (const Method& method : methods_) climb(bench, method);
    refine(bench);
    const Row* chosen = best();
    if (chosen == nullptr) refuse(truth);
    const std::string tried =
        std::to_string(rows_.size()) + " settings measured; noise of the reference " + printNumber(truth.floorFull, 3);
    image::writeFileAtomically(path, nlohmann::ordered_json{{"row", toJson(*chosen)}, {"tried", tried}}.dump(1) + "\n");
    return {optionsOf(*chosen), describe(*chosen) + " (" + tried + ")"};
  }

 private:
  static std::string openFolder() {
    const std::string pipelines = cli::pipelineCacheFile();
    const fs::path folder =
        pipelines.empty() ? fs::temp_directory_path() / "radivox_calibration" : fs::path(pipelines).parent_path() / "calibration";
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) {
      throw Error(ErrorCode::BadInput, "'" + folder.string() + "': cannot make this folder for calibrations (" + error.message() +
                                           "); set RADIVOX_PIPELINE_CACHE to a file in a folder that can be written");
    }
    return folder.string();
  }

  /// Of this budget: asked again, it gets the same answer at once.
  std::string choicePath() const {
    ContentKey key;
    key.add(sceneKey_).add(options_.aovs).add(printNumber(budget_.maxError.value_or(0))).add(printNumber(budget_.milliseconds.value_or(0)));
    for (const Method& method : methods_) key.add(method.graph).add(method.preset).add(method.bounces);
    for (const std::string& set : options_.sets) key.add(set);
    return folder_ + "/choice_" + key.print() + ".json";
  }

  std::optional<Choice> readChoice(const std::string& path) const {
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    try {
      const nlohmann::json json = nlohmann::json::parse(file);
      const Row row = rowFromJson(json.at("row"));
      const bool known = std::any_of(methods_.begin(), methods_.end(),
                                     [&](const Method& m) { return m.graph == row.setting.graph && m.preset == row.setting.preset; });
      if (!known || !keepsTime(row) || !keepsError(row)) return std::nullopt;
      return Choice{optionsOf(row), describe(row) + " (from before: " + json.at("tried").get<std::string>() + ")"};
    } catch (const nlohmann::json::exception&) {
      return std::nullopt;  // cut short, or of another version: chosen again
    }
  }

  std::vector<std::string> methodNames() const {
    if (options_.graph) return {*options_.graph};
    if (!options_.presets.empty()) return {options_.presets.front()};
    // Other graphs lack some AOVs and nodes of the one that is meant without --graph.
    if (options_.aovs != "color" || !options_.sets.empty()) return {cli::kDefaultPreset};
    return {"direct", cli::kFaceGraph, cli::kDefaultPreset};
  }

  SceneTruth trace(const scene::CameraDescription& camera) {
    TruthOptions options;
    options.width = size_.width;
    options.height = size_.height;
    options.bounces = options_.bounces ? cli::parseBounces(*options_.bounces) : scene::kAllBounces;
    options.cacheFolder = folder_;
    options.targetError = budget_.maxError ? std::min(kReferenceError, 0.25 * *budget_.maxError) : kReferenceError;
    options.timeLimit = kReferenceShare * budget_.calibrationSeconds;
    options.cancelled = cli::isInterrupted;
    options.progress = [this](std::string_view what, double fraction) { bar_.show("calibration: " + std::string(what), fraction); };
    return findTruth(scene_, camera, options);
  }

  bool isOver() const { return clock_.elapsed() > budget_.calibrationSeconds; }
  bool keepsTime(const Row& row) const { return !budget_.milliseconds || row.cost.totalMs() <= *budget_.milliseconds; }
  bool keepsError(const Row& row) const { return !budget_.maxError || row.full.relRmse <= *budget_.maxError; }
  /// By what is asked for: an error bound wants time, a time bound wants quality.
  bool isBetter(const Row& a, const Row& b) const {
    return budget_.maxError ? a.cost.totalMs() < b.cost.totalMs() : a.full.relRmse < b.full.relRmse;
  }

  const Row* best() const {
    const Row* found = nullptr;
    for (const Row& row : rows_) {
      if (keepsTime(row) && keepsError(row) && (found == nullptr || isBetter(row, *found))) found = &row;
    }
    return found;
  }

  const Method& methodOf(const Setting& setting) const {
    return *std::find_if(methods_.begin(), methods_.end(),
                         [&](const Method& m) { return m.graph == setting.graph && m.preset == setting.preset; });
  }

  /// Resolutions from the lowest up, until the time or the calibration ends, or the error is reached.
  void climb(const Bench& bench, const Method& method) {
    const auto knob = std::find_if(method.knobs.begin(), method.knobs.end(), [](const Knob& k) { return k.name == kResolution; });
    if (knob == method.knobs.end()) {
      tryOne(bench, {method.graph, method.preset, {}, method.bounces, 0});
      return;
    }
    double lastMs = 0;
    for (const std::string& value : knob->values) {
      const Row* row = tryOne(bench, {method.graph, method.preset, {{kResolution, value}}, method.bounces, 0}, 2 * lastMs);
      if (row == nullptr || !keepsTime(*row) || (budget_.maxError && keepsError(*row))) return;
      lastMs = row->cost.totalMs();
    }
  }

  /// Beside the best so far, or beside what came nearest, while that gains.
  void refine(const Bench& bench) {
    while (!isOver()) {
      const Row* from = best();
      if (from == nullptr) from = nearest();
      if (from == nullptr) return;
      const std::string before = from->key;
      const Setting setting = from->setting;
      if (!refined_.insert(setting.print()).second) return;
      const double expectedMs = from->cost.totalMs();
      for (const Trial& trial : neighbours(methods_, setting)) tryOne(bench, trial.setting, expectedMs);
      const Row* after = best();
      if (after == nullptr || after->key == before) return;
    }
  }

  /// Of a budget that nothing keeps.
  const Row* nearest() const {
    const Row* found = nullptr;
    for (const Row& row : rows_) {
      const auto far = [&](const Row& r) { return budget_.milliseconds && !keepsTime(r) ? r.cost.totalMs() : r.full.relRmse; };
      if (found == nullptr || far(row) < far(*found)) found = &row;
    }
    return found;
  }

  /// Null where there is no time left, or the device cannot. The row is good until the next call.
  const Row* tryOne(const Bench& bench, const Setting& setting, double expectedMs = 0) {
    cli::stopIfInterrupted();
    cli::Job job;
    cli::prepareJob(optionsFor(options_, methodOf(setting), setting), false, job);
    Row row;
    row.scene = options_.scene;
    row.setting = setting;
    row.key = ContentKey()
                  .add(sceneKey_)
                  .add(job.graph.toJson())
                  .add(job.lightParams.print())
                  .add(job.request.bounces)
                  .add(job.supersample)
                  .print();
    for (const Row& known : rows_) {
      if (known.key == row.key) return &known;
    }
    if (!cache_.find(row.key, folder_, row)) {
      const bool fits = clock_.elapsed() + 1e-3 * kMeasureFactor * expectedMs < budget_.calibrationSeconds;
      if (!fits && !rows_.empty()) return nullptr;
      bar_.show("calibration: " + setting.print(), clock_.elapsed() / budget_.calibrationSeconds);
      try {
        measure(bench, job, row);
      } catch (const Error& e) {
        cli::stopIfInterrupted();
        if (e.code() != ErrorCode::OutOfMemory && e.code() != ErrorCode::Unsupported) throw;
        return nullptr;
      }
      cache_.keep(row);
    }
    rows_.push_back(std::move(row));
    return &rows_.back();
  }

  cli::Options optionsOf(const Row& row) const {
    cli::Options chosen = optionsFor(options_, methodOf(row.setting), row.setting);
    chosen.aovs = options_.aovs;
    return chosen;
  }

  [[noreturn]] void refuse(const SceneTruth& truth) const {
    const Row* row = nearest();
    const std::string found = row == nullptr ? "nothing could be measured" : "nearest was " + describe(*row);
    std::string asked, mend;
    if (budget_.maxError) {
      asked = "--max-error " + printNumber(*budget_.maxError, 3);
      mend = truth.floorFull > *budget_.maxError
                 ? "; the reference's own noise is " + printNumber(truth.floorFull, 3) + ", give more --calibration-time"
                 : "; allow more error, or more --calibration-time";
    }
    if (budget_.milliseconds) {
      asked += std::string(asked.empty() ? "" : " with ") + "--budget-ms " + printNumber(*budget_.milliseconds, 3);
      if (mend.empty()) mend = "; allow more time, or a smaller --size";
    }
    throw Error(ErrorCode::Unsupported, asked + ": no setting keeps it here; " + found + mend);
  }

  const cli::Options& options_;
  const Budget& budget_;
  cli::Size size_;
  scene::Scene scene_;
  std::string folder_;
  RowCache cache_;
  std::unique_ptr<gpu::Device> device_;
  cli::ProgressBar bar_;
  Clock clock_{0};
  std::string sceneKey_;
  std::vector<Method> methods_;
  std::vector<Row> rows_;
  std::set<std::string> refined_;
};

}  // namespace

Choice chooseSetting(const cli::Options& options, const Budget& budget) { return Calibration(options, budget).run(); }

}  // namespace radivox::report
