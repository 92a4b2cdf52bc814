// radivox compare: how wrong a picture is, in figures and as a picture.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "engine/error.h"
#include "engine/image/flip.h"
#include "samples/cli/interrupt.h"
#include "samples/cli/layers.h"
#include "samples/cli/options.h"

namespace radivox::cli {

namespace {

using nlohmann::ordered_json;

std::string extensionOf(const std::string& path) { return std::filesystem::path(path).extension().string(); }

void checkOutputs(const Options& options) {
  if (!options.json.empty()) {
    if (extensionOf(options.json) != ".json") throw Error(ErrorCode::BadInput, "--json '" + options.json + "': end the name in .json");
    image::checkWritable(options.json);
  }
  if (options.outputs.size() > 1) throw Error(ErrorCode::BadInput, "--out is there twice; give one .exr or .png file");
  for (const std::string& path : options.outputs) {
    if (extensionOf(path) != ".exr" && extensionOf(path) != ".png") {
      throw Error(ErrorCode::BadInput, "--out '" + path + "': unknown kind of file; end the name in .exr or .png");
    }
    image::checkWritable(path);
  }
}

void printLine(const char* name, double value, const std::string& more = {}) {
  std::printf("%-12s %10.6g%s%s\n", name, value, more.empty() ? "" : "   ", more.c_str());
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

struct Figures {
  image::Comparison c;
  image::FlipMap ldr;
  std::optional<image::HdrFlipMap> hdr;
};

void print(const Figures& f, uint64_t leftOut) {
  const auto& u = f.c.uncertainty;
  printLine("pixels", static_cast<double>(f.c.pixelCount),
            leftOut > 0 ? std::to_string(leftOut) + " of them count as 0: no surface that reflects" : "");
  printLine("bias", f.c.bias, u ? format("± %.2g (95 %%)", 1.96 * u->biasError) : "mean(test)/mean(reference)");
  printLine("rmse", f.c.rmse,
            u ? format("%.6g to %.6g (95 %%); the reference's own noise is %.4g", u->rmseLow, u->rmseHigh, u->floorRmse) : "");
  printLine("relmse", f.c.relMse, u ? format("the reference's own noise is %.4g", u->floorRelMse) : "");
  printLine("psnr", f.c.psnr, u ? format("dB; one half of the reference against the other: %.2f dB", u->psnrHalves) : "dB");
  printLine("psnr_4x4", f.c.psnrBlocks,
            u ? format("dB on 4x4 block means; one half against the other: %.2f dB", u->psnrBlocksHalves) : "dB on 4x4 block means");
  printLine("flip", f.ldr.mean, format("99th percentile %.6g", f.ldr.percentile));
  if (f.hdr) {
    printLine("hdr_flip", f.hdr->mean,
              format("99th percentile %.6g; %u exposures from %.4f to %.4f stops", f.hdr->percentile, f.hdr->exposureCount,
                     f.hdr->startExposure, f.hdr->stopExposure));
  }
}

ordered_json toJson(const Options& options, const std::vector<std::string>& references, const Figures& f, uint64_t leftOut) {
  ordered_json json = {{"reference", references},
                       {"test", options.test},
                       {"layer", options.layer},
                       {"pixels", f.c.pixelCount},
                       {"pixels_left_out", leftOut},
                       {"mean_reference", f.c.meanReference},
                       {"mean_test", f.c.meanTest},
                       {"bias", f.c.bias},
                       {"mse", f.c.mse},
                       {"rmse", f.c.rmse},
                       {"plain_rmse", f.c.plainRmse},
                       {"relmse", f.c.relMse},
                       {"exposure", f.c.exposure},
                       {"psnr", f.c.psnr},
                       {"psnr_4x4", f.c.psnrBlocks},
                       {"flip", {{"mean", f.ldr.mean}, {"percentile_99", f.ldr.percentile}}}};
  if (f.hdr) {
    json["hdr_flip"] = {{"mean", f.hdr->mean},
                        {"percentile_99", f.hdr->percentile},
                        {"start_exposure", f.hdr->startExposure},
                        {"stop_exposure", f.hdr->stopExposure},
                        {"exposure_count", f.hdr->exposureCount}};
  }
  if (f.c.uncertainty) {
    const image::Uncertainty& u = *f.c.uncertainty;
    json["uncertainty"] = {{"mse_standard_error", u.mseError},     {"bias_standard_error", u.biasError},
                           {"rmse_95", {u.rmseLow, u.rmseHigh}},   {"floor_rmse", u.floorRmse},
                           {"floor_relmse", u.floorRelMse},        {"psnr_halves", u.psnrHalves},
                           {"psnr_4x4_halves", u.psnrBlocksHalves}};
  }
  return json;
}

void writeErrorPicture(const std::string& path, const Figures& f, const image::Image& reference, const image::Image& test) {
  if (extensionOf(path) == ".png") return image::writePng(path, image::paintHeat(f.hdr ? f.hdr->error : f.ldr.error));
  image::Image difference = test;
  for (size_t i = 0; i < difference.data.size(); ++i) difference.data[i] -= reference.data[i];
  std::vector<image::Layer> layers = {{"color", image::paintHeat(f.ldr.error)}, {"flip", f.ldr.error}, {"difference", difference}};
  if (f.hdr) layers.push_back({"hdr_flip", f.hdr->error});
  image::writeExr(path, layers);
}

}  // namespace

int runCompare(const Options& options) {
  checkOutputs(options);
  if (options.test.empty()) {
    throw Error(ErrorCode::BadInput, "REF and TEST are needed; give two pictures, as in `radivox compare truth.exr mine.exr`");
  }
  const std::vector<std::string> references = splitReference(options.reference);
  if (!options.weights.empty() && references.size() == 1) {
    throw Error(ErrorCode::BadInput, "--weights is for a reference in two halves; give REF as A.exr,B.exr");
  }
  const double shareOfA = options.weights.empty() ? 0.5 : parseWeights(options.weights);
  std::vector<PictureFile> files;
  for (const std::string& path : references) files.push_back(readPicture(path));
  const PictureFile testFile = readPicture(options.test);
  for (const PictureFile& file : files) {
    if (file.displayReferred == testFile.displayReferred) continue;
    throw Error(ErrorCode::BadInput, "'" + file.path + "' and '" + testFile.path +
                                         "': a .png holds what a screen shows, a .exr linear light; give two files of one kind");
  }
  const LayerTruth truth = takeTruth(files, options.layer, shareOfA);
  image::Image test = takeLayer(testFile, options.layer);
  // The reference may have albedo 0 where the test holds nonsense, which is then no error.
  truth.maskPixels(test);
  const image::Image& mean = truth.truth.mean;
  image::checkComparable(mean, test, "'" + references[0] + "'", "'" + options.test + "'");
  stopIfInterrupted();

  Figures f;
  f.c = image::compare(truth.truth, test, testFile.displayReferred ? std::optional<float>(1.f) : std::nullopt);
  stopIfInterrupted();
  const auto exposure = static_cast<float>(f.c.exposure);
  f.ldr = image::flip(image::scaled(mean, exposure), image::scaled(test, exposure));
  stopIfInterrupted();
  if (!testFile.displayReferred) f.hdr = image::hdrFlip(mean, test);
  stopIfInterrupted();

  print(f, truth.leftOutCount());
  if (!options.json.empty()) {
    const ordered_json json = toJson(options, references, f, truth.leftOutCount());
    image::writeFileAtomically(options.json, json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
  }
  for (const std::string& path : options.outputs) writeErrorPicture(path, f, mean, test);
  return 0;
}

}  // namespace radivox::cli
