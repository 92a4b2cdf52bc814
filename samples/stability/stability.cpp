// radivox stability: every case for every method, each against its known answer; then the page and the table.
#include <chrono>
#include <filesystem>
#include <iostream>

#include "engine/error.h"
#include "samples/cli/assets.h"
#include "samples/cli/cache.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/job.h"
#include "samples/cli/progress.h"
#include "samples/stability/cases.h"
#include "samples/stability/options.h"
#include "samples/stability/table.h"

namespace radivox::stability {

namespace {

namespace fs = std::filesystem;

constexpr const char* kIndirect = "irradiance_indirect";
constexpr int kSomeFailed = 1;

/// Methods by name, and what each is made from.
class Methods {
 public:
  Methods(const SuiteOptions& options, const plugin::Registry& registry) : registry_(registry) {
    if (options.methods.empty()) {
      for (const cli::Asset& asset : cli::graphs()) {
        if (graph::Graph::fromJson(asset.text, asset.name, registry).aovs().count(kIndirect) != 0) names_.push_back(asset.name);
      }
    }
    for (const std::string& method : options.methods) {
      const cli::Source source = cli::findGraph(method);
      if (graph::Graph::fromJson(source.text, source.source, registry).aovs().count(kIndirect) == 0) {
        throw Error(ErrorCode::BadInput, "--method '" + method + "': " + source.source + " has no AOV " + kIndirect +
                                             ", by which methods are judged; name it in the graph's aovs");
      }
      names_.push_back(source.name);
      files_.push_back(source);
    }
  }
  const std::vector<std::string>& names() const { return names_; }
  graph::Graph make(const std::string& name) const {
    for (const cli::Source& file : files_) {
      if (file.name == name) return graph::Graph::fromJson(file.text, file.source, registry_);
    }
    const cli::Source source = cli::findGraph(name);
    return graph::Graph::fromJson(source.text, source.source, registry_);
  }

 private:
  const plugin::Registry& registry_;
  std::vector<std::string> names_;
  std::vector<cli::Source> files_;
};

struct Entry {
  std::string method;
  const Case* which;
};

bool isWanted(const SuiteOptions& options, const Case& which) {
  if (options.fast && !which.fast) return false;
  return options.match.empty() || (which.group + ": " + which.name).find(options.match) != std::string::npos;
}

std::vector<Entry> listEntries(const SuiteOptions& options, const Methods& methods, const Cases& common, const plugin::Registry& registry) {
  std::vector<Entry> entries;
  for (const std::string& method : methods.names()) {
    for (const Case& which : common) {
      if (isWanted(options, which)) entries.push_back({method, &which});
    }
    for (const Case& which : registry.stabilityCases()) {
      if ((which.method.empty() || which.method == method) && isWanted(options, which)) entries.push_back({method, &which});
    }
  }
  if (entries.empty()) {
    throw Error(ErrorCode::BadInput, options.match.empty()
                                         ? std::string("no method, no case: give --method")
                                         : "--case '" + options.match + "': no case has this in its name; leave it out to see all");
  }
  return entries;
}

void makeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path)) {
    throw Error(ErrorCode::BadInput, "--out '" + path + "': cannot make this folder (" +
                                         (error ? error.message() : "a file of this name is there") + "); choose another");
  }
}

}  // namespace

int runStability(const SuiteOptions& options, const cli::Options& common) {
  if (options.out.empty()) throw Error(ErrorCode::BadInput, "--out is missing; give a folder to write stability.html and stability.csv to");
  const double timeLimit = options.timeLimit.empty() ? 0 : cli::parsePositive("--time-limit", options.timeLimit);
  const int deviceIndex = cli::parseDevice(common.device);
  gpu::DeviceOptions deviceOptions;
  deviceOptions.index = deviceIndex;
  deviceOptions.validation = common.validate;
  deviceOptions.pipelineCacheFile = cli::pipelineCacheFile();
  deviceOptions.onMessage = [](const std::string& message) {
    std::cerr << "radivox: validation: " << message.substr(0, message.find('\n')) << "\n";
  };

  plugin::Registry registry;
  cli::fillRegistry(common, registry);
  const Methods methods(options, registry);
  Cases cases;
  addStiffCases(cases);
  addLightCases(cases);
  addGeometryCases(cases);
  addViewCases(cases);
  addLeakCases(cases);
  const std::vector<Entry> entries = listEntries(options, methods, cases, registry);
  makeFolder(options.out);
  const std::string page = options.out + "/stability.html", csv = options.out + "/stability.csv";
  image::checkWritable(page);
  image::checkWritable(csv);

  const auto device = gpu::Device::create(deviceOptions);
  Table table{device->capabilities().deviceName, device->capabilities().driverName + " " + device->capabilities().driverInfo, 0, {}};
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  {
    cli::ProgressBar bar;
    for (size_t i = 0; i < entries.size(); ++i) {
      const auto& [method, which] = entries[i];
      cli::stopIfInterrupted();
      bar.show(method + ": " + which->name, static_cast<double>(i) / static_cast<double>(entries.size()));
      Row row;
      if (timeLimit > 0 && elapsed() > timeLimit) {
        row.verdict = Verdict::Skipped;
        row.note = "the time limit was over";
      } else {
        Bench bench(
            *device, method, [&](const std::string& name) { return methods.make(name); }, cli::isInterrupted);
        row = runCase(*which, bench);
      }
      table.rows.push_back({method, which->group, which->name, which->answer, std::move(row)});
    }
  }
  table.seconds = elapsed();
  image::writeFileAtomically(csv, printCsv(table));
  image::writeFileAtomically(page, printPage(table));
  const size_t failed = table.count(Verdict::Fail);
  std::cout << page << ": " << table.rows.size() << " cases, " << table.count(Verdict::Pass) << " pass, " << table.count(Verdict::Degraded)
            << " degraded as stated, " << table.count(Verdict::Refused) << " refused, " << failed << " fail\n";
  if (failed == 0) return 0;
  std::string names;
  for (const TableRow& r : table.rows) {
    if (r.row.verdict == Verdict::Fail) names += (names.empty() ? "" : "; ") + r.method + ": " + r.name;
  }
  std::cerr << "radivox: " << failed << " stability cases fail (" << names << "); see " << page << "\n";
  return kSomeFailed;
}

}  // namespace radivox::stability
