// Images in host memory and their files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace radivox::image {

/// Planar-free float image: `channels` per pixel, interleaved, rows from the top.
struct Image {
  uint32_t width = 0, height = 0, channels = 3;
  std::vector<float> data;
  float& at(uint32_t x, uint32_t y, uint32_t c) { return data[(static_cast<size_t>(y) * width + x) * channels + c]; }
  float at(uint32_t x, uint32_t y, uint32_t c) const { return data[(static_cast<size_t>(y) * width + x) * channels + c]; }
};

struct Layer {
  std::string name;  ///< "color" is written as R, G, B; others as NAME.R …; one channel as NAME.V
  Image image;
};

/// 32-bit float, ZIP. Written to a temporary name beside `path`, then renamed. Throws BadInput (folder missing, not writable, disk full).
void writeExr(const std::string& path, const std::vector<Layer>& layers);
/// Every layer of a file, half or float. Throws BadInput naming file and mend.
std::vector<Layer> readExr(const std::string& path);
/// 8-bit sRGB from values already display-referred in [0, 1] (linear → sRGB encoding applied here). NaN is an error that names the pixel.
void writePng(const std::string& path, const Image& linear);
Image readPng(const std::string& path);  ///< linear values

/// Multiplies so that the luminance's 99th percentile is 1 (or 1 where the image is black); returns the factor.
float exposureOf(const Image& linear);
Image scaled(const Image& image, float factor);
/// Means over k×k blocks (the image is cropped to a multiple).
Image blockMeans(const Image& image, uint32_t k);
/// PSNR in dB of images exposed so that the reference's 99th percentile is 1, clamped, sRGB-encoded (METHODS section 5).
double psnr(const Image& reference, const Image& test);
double meanOf(const Image& image);

/// Writes `bytes` to a temporary name beside `path`, flushes, renames. Throws BadInput.
void writeFileAtomically(const std::string& path, const std::string& bytes);

}  // namespace radivox::image
