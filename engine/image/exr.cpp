#include <IexBaseExc.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "engine/error.h"
#include "engine/image/image.h"

namespace radivox::image {

namespace {

constexpr int64_t kMaxSide = 65536;
/// More than any OpenEXR codec reaches on a constant image: a file that claims more pixels is broken, and is not given the memory.
constexpr uint64_t kMaxCompression = 2048;

[[noreturn]] void refuseRead(const std::string& path, std::string why) {
  std::replace(why.begin(), why.end(), '\n', ' ');
  throw Error(ErrorCode::BadInput, "cannot read '" + path + "': " + why);
}

/// The file in memory, so that it can be put in place in one step.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : Imf::OStream("memory") {}
  void write(const char c[], int n) override {
    const size_t count = static_cast<size_t>(n);
    if (position_ + count > bytes.size()) bytes.resize(position_ + count);
    std::memcpy(bytes.data() + position_, c, count);
    position_ += count;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }

  std::string bytes;

 private:
  size_t position_ = 0;
};

std::vector<std::string> channelNames(const Layer& layer) {
  const bool color = layer.name == "color";
  std::vector<std::string> names;
  switch (layer.image.channels) {
    case 1:
      names = {color ? "Y" : "V"};
      break;
    case 2:
      names = {"X", "Y"};
      break;
    case 3:
      names = {"R", "G", "B"};
      break;
    case 4:
      names = {"R", "G", "B", "A"};
      break;
    default:
      break;
  }
  if (!color) {
    for (std::string& name : names) name = layer.name + "." + name;
  }
  return names;
}

/// Channels in the order people expect: R G B A and X Y Z W, else by name.
size_t channelRank(const std::string& name) {
  static const std::string kOrder = "RGBAXYZW";
  return name.size() == 1 && kOrder.find(name) != std::string::npos ? kOrder.find(name) : kOrder.size();
}

struct NamedChannel {
  std::string full, suffix;
};

std::vector<Layer> readPart(const std::string& path, Imf::MultiPartInputFile& file, int partIndex) {
  Imf::InputPart part(file, partIndex);
  const Imf::Header& header = part.header();
  const Imath::Box2i window = header.dataWindow();
  const int64_t width = static_cast<int64_t>(window.max.x) - window.min.x + 1;
  const int64_t height = static_cast<int64_t>(window.max.y) - window.min.y + 1;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    refuseRead(path,
               "its data window is " + std::to_string(width) + "x" + std::to_string(height) + "; sides of 1 to 65536 pixels can be read");
  }
  uint64_t channelCount = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) ++channelCount;
  const uint64_t smallestBytes = static_cast<uint64_t>(width * height) * channelCount * 2;
  if (smallestBytes / kMaxCompression > std::filesystem::file_size(path)) {
    refuseRead(path, "it claims " + std::to_string(width) + "x" + std::to_string(height) + " pixels, but is far too short; copy it again");
  }
  const std::string partName = file.parts() > 1 && header.hasName() ? header.name() : "";
  std::map<std::string, std::vector<NamedChannel>> byLayer;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    const std::string name = it.name();
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) {
      refuseRead(path, "channel '" + name + "' is subsampled; save it with full-size RGB channels");
    }
    const size_t dot = name.rfind('.');
    std::string layer;
    if (dot != std::string::npos) {
      layer = name.substr(0, dot);
    } else if (!partName.empty()) {
      layer = partName;
    } else {
      const bool color = name.size() == 1 && std::string("RGBAY").find(name) != std::string::npos;
      layer = color ? "color" : name;
    }
    byLayer[layer].push_back({name, dot == std::string::npos ? name : name.substr(dot + 1)});
  }

  std::vector<Layer> layers;
  layers.reserve(byLayer.size());  // the frame buffer points into the images
  Imf::FrameBuffer frame;
  for (auto& [name, channels] : byLayer) {
    std::stable_sort(channels.begin(), channels.end(),
                     [](const NamedChannel& a, const NamedChannel& b) { return channelRank(a.suffix) < channelRank(b.suffix); });
    Layer& layer = layers.emplace_back();
    layer.name = name;
    layer.image.width = static_cast<uint32_t>(width);
    layer.image.height = static_cast<uint32_t>(height);
    layer.image.channels = static_cast<uint32_t>(channels.size());
    layer.image.data.resize(static_cast<size_t>(width * height) * channels.size());
    const size_t pixelBytes = sizeof(float) * channels.size();
    for (size_t c = 0; c < channels.size(); ++c) {
      frame.insert(channels[c].full,
                   Imf::Slice::Make(Imf::FLOAT, layer.image.data.data() + c, window, pixelBytes, pixelBytes * static_cast<size_t>(width)));
    }
  }
  part.setFrameBuffer(frame);
  part.readPixels(window.min.y, window.max.y);
  return layers;
}

}  // namespace

void writeExr(const std::string& path, const std::vector<Layer>& layers) {
  const auto refuse = [&path](const std::string& why) { throw Error(ErrorCode::BadInput, "cannot write '" + path + "': " + why); };
  if (layers.empty()) refuse("there is no layer to write; ask for at least one");
  const uint32_t width = layers[0].image.width, height = layers[0].image.height;
  if (width == 0 || height == 0) refuse("the image is empty; give it at least one pixel");
  Imf::Header header(static_cast<int>(width), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer frame;
  for (const Layer& layer : layers) {
    const Image& image = layer.image;
    if (image.width != width || image.height != height || image.channels < 1 || image.channels > 4 ||
        image.data.size() != static_cast<size_t>(width) * height * image.channels) {
      refuse("layer '" + layer.name + "' is " + std::to_string(image.width) + "x" + std::to_string(image.height) + " with " +
             std::to_string(image.channels) + " channels; layers of one file have the same size and 1 to 4 channels");
    }
    const std::vector<std::string> names = channelNames(layer);
    const size_t pixelBytes = sizeof(float) * image.channels;
    for (size_t c = 0; c < names.size(); ++c) {
      if (header.channels().findChannel(names[c]) != nullptr) refuse("layer '" + layer.name + "' is there twice; name it once");
      header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
      // OpenEXR takes no pointer to const, but only reads.
      char* base = const_cast<char*>(reinterpret_cast<const char*>(image.data.data() + c));
      frame.insert(names[c], Imf::Slice(Imf::FLOAT, base, pixelBytes, pixelBytes * width));
    }
  }
  MemoryStream stream;
  try {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(frame);
    file.writePixels(static_cast<int>(height));
  } catch (const Iex::BaseExc& e) {
    refuse(e.what());
  }
  writeFileAtomically(path, stream.bytes);
}

std::vector<Layer> readExr(const std::string& path) {
  if (std::filesystem::is_directory(path)) refuseRead(path, "it is a folder; give a .exr file");
  if (!std::ifstream(path)) refuseRead(path, "no such file, or it is not readable; check the path");
  std::vector<Layer> layers;
  try {
    Imf::MultiPartInputFile file(path.c_str());
    for (int part = 0; part < file.parts(); ++part) {
      const Imf::Header& header = file.header(part);
      if (header.hasType() && Imf::isDeepData(header.type())) continue;
      for (Layer& layer : readPart(path, file, part)) layers.push_back(std::move(layer));
    }
  } catch (const Iex::BaseExc& e) {
    refuseRead(path, std::string(e.what()) + "; write it again as OpenEXR scanlines");
  }
  if (layers.empty()) refuseRead(path, "it holds no flat image; give a file with scanline or tiled parts");
  return layers;
}

}  // namespace radivox::image
