#include "samples/cli/layers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "engine/error.h"

namespace radivox::cli {

namespace {

const image::Layer* findLayer(const PictureFile& file, const std::string& name) {
  const auto found = std::find_if(file.layers.begin(), file.layers.end(), [&](const image::Layer& l) { return l.name == name; });
  return found == file.layers.end() ? nullptr : &*found;
}

std::string nameOf(const PictureFile& file) { return "'" + file.path + "'"; }

}  // namespace

PictureFile readPicture(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".exr") return {path, false, image::readExr(path)};
  if (extension == ".png") return {path, true, {{"color", image::readPng(path)}}};
  throw Error(ErrorCode::BadInput, "'" + path + "': unknown kind of picture; give a .exr or .png file");
}

image::Image takeLayer(const PictureFile& file, const std::string& name) {
  const image::Layer* layer = file.layers.size() == 1 ? &file.layers.front() : findLayer(file, name);
  if (layer == nullptr) {
    std::string message = nameOf(file) + " has no layer '" + name + "'; there is";
    for (size_t i = 0; i < file.layers.size(); ++i) message += (i == 0 ? " " : ", ") + file.layers[i].name;
    throw Error(ErrorCode::BadInput, message);
  }
  const image::Image& from = layer->image;
  if (from.channels != 4) return from;
  image::Image result{from.width, from.height, 3, {}};
  result.data.reserve(from.data.size() / 4 * 3);
  for (size_t i = 0; i < from.data.size(); i += 4) result.data.insert(result.data.end(), &from.data[i], &from.data[i] + 3);
  return result;
}

std::vector<std::string> splitReference(const std::string& text) {
  const size_t comma = text.find(',');
  if (comma == std::string::npos || std::filesystem::exists(text)) return {text};
  const std::vector<std::string> halves = {text.substr(0, comma), text.substr(comma + 1)};
  if (halves[0].empty() || halves[1].empty() || halves[1].find(',') != std::string::npos) {
    throw Error(ErrorCode::BadInput, "reference '" + text + "': give one file, or two independent halves with one comma between them");
  }
  return halves;
}

double parseWeights(const std::string& text) {
  double a = 0, b = 0;
  int length = 0;
  const bool read = std::sscanf(text.c_str(), "%lf,%lf%n", &a, &b, &length) == 2 && static_cast<size_t>(length) == text.size();
  if (!read || !(a > 0) || !(b > 0) || !std::isfinite(a + b)) {
    throw Error(ErrorCode::BadInput, "--weights '" + text + "': give two numbers above 0, the samples of each half, as in 256,512");
  }
  return a / (a + b);
}

void LayerTruth::maskPixels(image::Image& image) const {
  for (size_t pixel = 0; pixel < leftOut.size(); ++pixel) {
    if (leftOut[pixel] != 0) std::fill_n(image.data.begin() + static_cast<std::ptrdiff_t>(pixel * image.channels), image.channels, 0.f);
  }
}

uint64_t LayerTruth::leftOutCount() const {
  return static_cast<uint64_t>(std::count_if(leftOut.begin(), leftOut.end(), [](char c) { return c != 0; }));
}

LayerTruth takeTruth(const std::vector<PictureFile>& files, const std::string& layer, double shareOfA) {
  LayerTruth result;
  std::vector<image::Image> images;
  for (const PictureFile& file : files) {
    images.push_back(takeLayer(file, layer));
    image::checkComparable(images.front(), images.back(), nameOf(files.front()), nameOf(file));
  }
  if (layer.rfind("irradiance", 0) == 0) {
    for (const PictureFile& file : files) {
      const image::Layer* albedo = findLayer(file, "albedo");
      if (albedo == nullptr || albedo->image.channels < 3) continue;
      const size_t pixelCount = images.front().data.size() / images.front().channels;
      if (albedo->image.data.size() != pixelCount * albedo->image.channels) continue;
      result.leftOut.resize(pixelCount);
      for (size_t i = 0; i < pixelCount; ++i) {
        const float* p = albedo->image.data.data() + i * albedo->image.channels;
        if (p[0] + p[1] + p[2] <= 0.f) result.leftOut[i] = 1;
      }
    }
  }
  for (image::Image& image : images) result.maskPixels(image);
  result.truth =
      images.size() == 1 ? image::truthOf(std::move(images[0])) : image::truthOf(std::move(images[0]), std::move(images[1]), shareOfA);
  return result;
}

}  // namespace radivox::cli
