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
/// Every layer of every scanline or tiled part, half, float or integer, over the data window. Channels without a layer: R, G, B, A and Y
/// make "color", any other is a layer of its own name. Throws BadInput naming file and mend.
std::vector<Layer> readExr(const std::string& path);
/// Radiance .hdr (RGBE): three channels, linear. Throws BadInput naming file and mend.
Image readHdr(const std::string& path);
/// 8-bit sRGB from values already display-referred in [0, 1] (linear → sRGB encoding applied here; a fourth channel is alpha and stays
/// linear). 1, 3 or 4 channels. NaN is an error that names the pixel.
void writePng(const std::string& path, const Image& linear);
/// The same from bytes that are encoded already: `channels` a pixel, rows from the top.
void writePngBytes(const std::string& path, uint32_t width, uint32_t height, uint32_t channels, const std::vector<uint8_t>& bytes);
Image readPng(const std::string& path);  ///< linear values, 8 or 16 bits
float encodeSrgb(float linear);          ///< clamps to [0, 1]
float decodeSrgb(float encoded);

/// The factor that makes the luminance's 99th percentile 1 (percentile by linear interpolation over the finite pixels); 1 where that
/// percentile is not above 0.
float exposureOf(const Image& linear);
Image scaled(const Image& image, float factor);
/// Means over k×k blocks (the image is cropped to a multiple).
Image blockMeans(const Image& image, uint32_t k);
/// PSNR in dB of images exposed so that the reference's 99th percentile is 1, clamped, sRGB-encoded (METHODS section 5).
double psnr(const Image& reference, const Image& test);
double psnr(const Image& reference, const Image& test, float exposure);
double meanOf(const Image& image);

/// Writes `bytes` to a temporary name beside `path`, flushes, renames: `path` holds the old file or the whole new one, never a part,
/// and a failure leaves nothing behind. A symbolic link is followed. Throws BadInput.
void writeFileAtomically(const std::string& path, const std::string& bytes);
/// Throws what writeFileAtomically would (folder missing, not writable, not a regular file), before the long work.
void checkWritable(const std::string& path);

}  // namespace radivox::image
