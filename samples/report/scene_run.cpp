#include "samples/report/scene_run.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <set>

#include "engine/error.h"
#include "samples/cli/interrupt.h"
#include "samples/report/content_key.h"
#include "samples/report/front.h"
#include "samples/report/measure.h"

namespace radivox::report {

namespace {

// Shares of a scene's time; the rest is for the methods.
constexpr double kReferenceShare = 0.3, kPathTracerShare = 0.1;
/// What writing the page takes at the end, seconds, at least; and as a share of the limit.
constexpr double kPageSeconds = 2, kPageShare = 0.04;
/// A setting that takes a larger share of what is left waits until all others are done; the next value of a parameter takes so much longer.
/// A sweep begins with what is cheap.
constexpr double kDearestShare = 0.25, kNextStep = 3, kFirstStep = 0.5;
constexpr uint32_t kSearchRounds = 3;
constexpr size_t kMostSearched = 40;  ///< settings a round
constexpr uint32_t kMostSamples = 1024;
constexpr double kPathTracerSeconds = 30;  ///< no curve point takes longer, without a limit

class SceneRun {
 public:
  SceneRun(Session& session, const std::string& source, const std::string& name, double shareOfTime)
      : session_(session), scene_(scene::loadScene(source, session.common.sky)), begin_(session.clock.elapsed()) {
    for (const std::string& warning : scene_.warnings) std::cerr << "radivox: warning: " << warning << "\n";
    results_.name = name;
    results_.source = source;
    results_.camera = session.common.camera;
    results_.triangles = scene_.triangleCount();
    if (session.clock.hasLimit()) {
      const double limit = session.clock.limit();
      const double page = std::max(kPageSeconds, kPageShare * limit);
      budget_ = std::max((session.clock.left() - page) * shareOfTime, 0.1);
    }
  }

  SceneResults run() {
    const scene::CameraDescription& camera = scene::findCamera(scene_, session_.common.camera.empty() ? "0" : session_.common.camera);
    TruthOptions truthOptions;
    truthOptions.width = session_.size.width;
    truthOptions.height = session_.size.height;
    truthOptions.bounces = session_.bounces;
    truthOptions.cacheFolder = session_.cacheFolder;
    truthOptions.targetError = session_.referenceError;
    if (budget_ > 0) truthOptions.timeLimit = std::min(truthOptions.timeLimit, kReferenceShare * budget_);
    truthOptions.cancelled = cli::isInterrupted;
    truthOptions.progress = [this](std::string_view what, double fraction) { show(what, fraction); };
    if (!session_.options.reference.empty()) {
      truthOptions.files = cli::splitReference(session_.options.reference);
      if (!session_.options.weights.empty()) truthOptions.shareOfA = cli::parseWeights(session_.options.weights);
    }
    const SceneTruth truth = findTruth(scene_, camera, truthOptions);
    cli::stopIfInterrupted();
    results_.truth = truth.about;
    results_.truthKey = truth.key;
    results_.floorFull = truth.floorFull;
    results_.floorIndirect = truth.floorIndirect;
    writeTruth(truth);
    Bench bench{session_.device, scene_, camera, truth, session_.pictures, {}, {}};
    bench.cancelled = [this] { return cli::isInterrupted() || isOver(); };
    bench.progress = [this](std::string_view node, double) { show(now_ + ": " + std::string(node), fraction_); };

    if (hasPathTracer()) traceCurve(bench, truthOptions);
    methods_ = findMethods(session_.common, session_.options.methods, scene_, session_.device.capabilities(), results_.notes);
    runTrials(bench, planTrials(methods_), "sweep");
    for (uint32_t round = 0; round < kSearchRounds && !isOver(); ++round) {
      std::vector<Trial> next = besideTheFront();
      if (next.empty()) break;
      if (next.size() > kMostSearched) next.resize(kMostSearched);
      runTrials(bench, next, "search");
    }
    if (leftOut_ > 0) {
      results_.notes.push_back(std::to_string(leftOut_) + " settings were not tried: the time limit was reached; the same command goes on");
    }
    std::vector<Row*> rows;
    for (Row& row : results_.rows) rows.push_back(&row);
    markFronts(rows);
    return std::move(results_);
  }

 private:
  double elapsed() const { return session_.clock.elapsed() - begin_; }
  bool isOver() const { return budget_ > 0 && elapsed() >= budget_; }

  void show(std::string_view what, double fraction) {
    if (budget_ > 0) fraction = elapsed() / budget_;
    session_.bar.show(results_.name + ": " + std::string(what), fraction);
  }

  void writeTruth(const SceneTruth& truth) {
    const std::string path = session_.pictures + "/reference_" + truth.key;
    image::writePng(path + ".color.png", image::scaled(truth.full.truth.mean, truth.exposureFull));
    image::writePng(path + ".indirect.png", image::scaled(truth.indirect.truth.mean, truth.exposureIndirect));
    results_.shareOfA = truth.shareOfA;
    if (!session_.options.reference.empty()) results_.truthFiles = cli::splitReference(session_.options.reference);
    for (size_t i = 0; i < truth.halves.size(); ++i) {
      results_.truthFiles.push_back(path + (i == 0 ? "_a.exr" : "_b.exr"));
      image::writeExr(results_.truthFiles.back(), truth.halves[i].layers);
    }
  }

  /// The path tracer at 1, 2, 4 … samples, as long as there is time for the next.
  void traceCurve(const Bench& bench, TruthOptions options) {
    double spent = 0, last = 0;
    const double most = budget_ > 0 ? kPathTracerShare * budget_ : HUGE_VAL;
    options.cancelled = bench.cancelled;
    for (uint32_t samples = 1; samples <= kMostSamples; samples *= 2) {
      Row row;
      row.scene = results_.name;
      row.setting.samples = samples;
      row.reasons = {why::kPathTracer};
      row.key = ContentKey()
                    .add("path tracer")
                    .add(session_.program)
                    .add(sceneKey(bench))
                    .add(bench.truth.key)
                    .add(session_.bounces)
                    .add(samples)
                    .print();
      if (!session_.cache.find(row.key, session_.pictures, row)) {
        if (samples > 1 && (spent + 2 * last > most || 2 * last > kPathTracerSeconds)) break;
        show("path tracer, " + std::to_string(samples) + " samples", static_cast<double>(samples) / kMostSamples);
        const auto traced = tracePicture(scene_, bench.camera, options, samples);
        cli::stopIfInterrupted();
        if (!traced) break;
        row.cost.sceneMs = 1e3 * traced->buildSeconds;
        row.cost.frameMs = 1e3 * traced->seconds;
        row.cost.wallSceneMs = row.cost.sceneMs + row.cost.frameMs;
        row.cost.wallLightMs = row.cost.wallFrameMs = row.cost.firstRunMs = row.cost.frameMs;
        row.cost.repeats = 1;
        judgePictures(bench, traced->color, traced->indirect, row);
        session_.cache.keep(row);
      }
      last = 1e-3 * row.cost.frameMs;
      spent += last;
      results_.rows.push_back(std::move(row));
    }
  }

  std::string sceneKey(const Bench& bench) {
    if (sceneKey_.empty())
      sceneKey_ = ContentKey().add(scene_).add(bench.camera).add(session_.size.width).add(session_.size.height).print();
    return sceneKey_;
  }

  void runTrials(const Bench& bench, const std::vector<Trial>& trials, const char* phase) {
    std::vector<const Trial*> deferred;
    for (size_t i = 0; i < trials.size(); ++i) {
      const double fraction = static_cast<double>(i) / static_cast<double>(trials.size());
      const std::string place = std::string(phase) + " " + std::to_string(i + 1) + " of " + std::to_string(trials.size());
      if (!tryOne(bench, trials[i], place, fraction, kDearestShare)) deferred.push_back(&trials[i]);
    }
    // What would have taken much of the time that others needed, the cheapest first.
    std::stable_sort(deferred.begin(), deferred.end(),
                     [this](const Trial* a, const Trial* b) { return expectedSeconds(*a) < expectedSeconds(*b); });
    for (const Trial* trial : deferred) {
      if (!tryOne(bench, *trial, std::string(phase) + ", the dearest", 1.0, 1.0)) ++leftOut_;
    }
  }

  /// False where it would take more than `share` of the time that is left.
  bool tryOne(const Bench& bench, const Trial& trial, const std::string& place, double fraction, double share) {
    cli::stopIfInterrupted();
    if (same_.count(trial.setting.method()) != 0) return true;
    const auto method = std::find_if(methods_.begin(), methods_.end(),
                                     [&](const Method& m) { return m.graph == trial.setting.graph && m.preset == trial.setting.preset; });
    cli::Job job;
    cli::prepareJob(optionsFor(session_.common, *method, trial.setting), false, job);
    const std::string key = keyOf(bench, job);
    if (const auto known = byKey_.find(key); known != byKey_.end()) {
      Row& row = results_.rows[known->second];
      if (!row.has(trial.reason)) row.reasons.push_back(trial.reason);
      // Two methods of the same content are one row, called by the first.
      if (trial.reason == why::kMethod && row.setting.method() != trial.setting.method()) {
        results_.notes.push_back(trial.setting.method() + " is the same as " + row.setting.print());
        same_.insert(trial.setting.method());
      }
      if (trial.reason == why::kExact || row.about.empty()) row.about = trial.about;
      return true;
    }
    Row row;
    row.scene = results_.name;
    row.key = key;
    row.setting = trial.setting;
    row.reasons = {trial.reason};
    row.about = trial.about;
    if (!session_.cache.find(key, session_.pictures, row)) {
      if (budget_ > 0 && expectedSeconds(trial) > share * (budget_ - elapsed())) return false;
      now_ = place + ", " + trial.setting.print();
      fraction_ = fraction;
      show(now_, fraction);
      const double start = session_.clock.elapsed();
      const bool measured = measureRow(bench, job, row);
      seconds_[trial.setting.method() + " " + trial.about] = session_.clock.elapsed() - start;
      if (!measured) return true;
    }
    byKey_[key] = results_.rows.size();
    results_.rows.push_back(std::move(row));
    return true;
  }

  /// From what its method took with the value before, or as it is; 0 where nothing is known.
  double expectedSeconds(const Trial& trial) const {
    if (const auto step = seconds_.find(trial.setting.method() + " " + trial.about); step != seconds_.end())
      return kNextStep * step->second;
    const auto asIs = seconds_.find(trial.setting.method() + " ");
    return asIs == seconds_.end() ? 0.0 : (trial.reason == why::kSweep ? kFirstStep : trial.effort) * asIs->second;
  }

  bool measureRow(const Bench& bench, cli::Job& job, Row& row) {
    try {
      measure(bench, job, row);
    } catch (const Error& e) {
      cli::stopIfInterrupted();
      if (isOver()) {
        ++leftOut_;
        return false;
      }
      // What does not fit or is not supported here is no reason to lose the rest.
      if (e.code() != ErrorCode::OutOfMemory && e.code() != ErrorCode::Unsupported) throw;
      results_.notes.push_back(row.setting.print() + ": left out: " + e.what());
      return false;
    }
    session_.cache.keep(row);
    return true;
  }

  std::string keyOf(const Bench& bench, const cli::Job& job) {
    const gpu::Capabilities& c = session_.device.capabilities();
    return ContentKey()
        .add(session_.program)
        .add(c.deviceName)
        .add(c.driverInfo)
        .add(sceneKey(bench))
        .add(bench.truth.key)
        .add(job.graph.toJson())
        .add(job.lightParams.print())
        .add(job.request.bounces)
        .add(job.supersample)
        .print();
  }

  std::vector<Trial> besideTheFront() {
    std::vector<Row*> rows;
    for (Row& row : results_.rows) rows.push_back(&row);
    markFronts(rows);
    std::vector<Trial> trials;
    std::set<std::string> seen;
    for (const Row* row : rows) {
      if (row->isPathTracer()) continue;
      if (!row->frontTotalFull && !row->frontTotalIndirect && !row->frontFrameFull && !row->frontFrameIndirect) continue;
      for (Trial& trial : neighbours(methods_, row->setting)) {
        if (searched_.insert(trial.setting.print()).second) trials.push_back(std::move(trial));
      }
    }
    return trials;
  }

  Session& session_;
  scene::Scene scene_;
  SceneResults results_;
  std::vector<Method> methods_;
  std::map<std::string, size_t> byKey_;
  std::set<std::string> searched_;
  std::set<std::string> same_;             ///< methods that are others by another name
  std::map<std::string, double> seconds_;  ///< "method knob" → what the last such row took to measure
  std::string sceneKey_;
  std::string now_;  ///< what is being measured
  double fraction_ = 0;
  double begin_, budget_ = 0;
  uint64_t leftOut_ = 0;
};

}  // namespace

SceneResults runScene(Session& session, const std::string& source, const std::string& name, double shareOfTime) {
  return SceneRun(session, source, name, shareOfTime).run();
}

}  // namespace radivox::report
